"""Counting what realisations need: the parameters that are counted are those that are estimated."""

import numpy as np

from benchmarks.affine_plant import with_constant
from benchmarks.cox_counting import countings, one_by_one, products, reduced_parameters
from identification.varying.correlation_analysis import WhiteExcitation
from identification.varying.sub_markov import every_word
from tests.support.random_state_space import random_affine, white_record


def test_one_by_one_or_together_they_are_the_same_parameters() -> None:
    generator = np.random.default_rng(5)
    record = white_record(random_affine(generator, 2, 2)[0], generator, 200, 20.0)
    source = WhiteExcitation(with_constant(record.scheduling), record.input).fit(record.output)
    words = every_word(2, 3, 2)
    together = source.hankel(words, words)
    assert np.allclose(one_by_one(source, list(products(words, words))), together.ravel())
    rows, columns = words.subset(np.array([0, 3, 9])), words.subset(np.array([8, 1, 2]))
    blocks = source.blocks(rows, columns)
    few = list(reduced_parameters(rows, columns, (3, 2, 2)))
    parts = (blocks.hankel, blocks.shifted, blocks.from_input.transpose(1, 0, 2), blocks.to_output)
    assert np.allclose(one_by_one(source, few), np.concatenate([part.ravel() for part in parts]))
    table = countings(source, 3, 2)
    assert (table[0]["reduced"], table[0]["full"]) == (len(few), together.size)
