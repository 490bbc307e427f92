"""The examples of [Kergus2019], [Akcay2008], [Goos2014] and [Cox2018], by the studies that run them."""

from benchmarks.papers.gallery import Cell, Paper, Part, results

LEVELS = ("inf", "40", "25", "10", "0")
OWN_SYSTEMS = "the paper's system is not public: random systems of its sizes"


def kergus(runs: int) -> Paper:
    """The academic example without noise and with it, and the open channel."""
    academic, channel = results("kergus_example", "--runs", str(runs)), results("open_channel")
    exact = tuple(
        Cell(f"{name}, relative error without noise", 0, error) for name, error in academic["noiseFree"].items()
    )
    poles = tuple(
        Cell(f"{name}, unstable somewhere on [0, 1], of {row['runs']}", 0 if "2" in name else None, row["unstable"])
        for name, row in academic["noisy"].items()
    )
    errors = tuple(
        Cell(f"{name}, largest error {where}", None, max(row[key]))
        for name, row in channel["models"].items()
        for where, key in (("at measured positions", "measured"), ("between them", "between"))
    )
    made = "The channel's matrices are not in the text: linearised Saint-Venant equations, a uniform channel."
    return Paper(
        "Kergus2019",
        "Parametric models by frequency-domain subspaces",
        (
            Part("Figure 1: exact without noise", "python -m benchmarks.kergus_example --page FILE.html", exact),
            Part("Figure 2: poles with noise", "python -m benchmarks.kergus_example --page FILE.html", poles),
            Part("Figure 3: the open channel", "python -m benchmarks.open_channel --page FILE.html", errors, text=made),
        ),
    )


def mckelvey() -> Paper:
    """Exactness of Theorems 1 and 3, consistency, and the comparison on a lightly damped structure."""
    exact, spread = results("subspace_exactness"), results("subspace_consistency", "--largest", "10000")
    compared = results("subspace_structure")
    slopes = tuple(
        Cell(f"{one['method']}, slope", None if "K = I" in one["method"] else -0.5, one["slope"], drawn=True)
        for one in spread["methods"]
    )
    table = tuple(Cell(f"{one['method']}, error (rms)", None, one["rms"]) for one in compared["methods"])
    orders = tuple(
        Cell(f"order chosen by {name}", 42, order, drawn=True) for name, order in compared["orders"]["chosen"].items()
    )
    made = f"The measured truss is not public: a structure of order 42, noise of {compared['noise']:.3g} a line."
    return Paper(
        "Akcay2008",
        "Subspaces from frequency responses",
        (
            Part(
                "Theorems 1 and 3: exact from the fewest lines",
                "python -m benchmarks.subspace_exactness",
                tuple(Cell(f"{one['case']}, largest relative error", 0, one["largest"]) for one in exact),
            ),
            Part(
                "Theorem 4: consistent with K, not without",
                "python -m benchmarks.subspace_consistency --page FILE.html",
                slopes,
                text="Slope of the logarithm of the error over that of the number of lines.",
            ),
            Part(
                "Comparison on a flexible structure, and its order",
                "python -m benchmarks.subspace_structure --page FILE.html",
                table + orders,
                text=made,
            ),
        ),
    )


def goos(runs: int) -> Paper:
    """Figures 4 and 5: variance accounted for, and eigenvalues inside their Cramér–Rao ellipses."""
    likelihood, moesp = results("wind_turbine", "--runs", str(runs), "--methods", "white", "moesp")
    inside = [100 * share for share in likelihood["inside the 95 % Cramér–Rao ellipses"]]
    vaf, spread = "VAF in %, mean", "VAF in %, standard deviation"
    note = f"{runs} runs at {likelihood['output over noise in dB']:.3g} dB, which the paper does not print"
    cells = (
        Cell("likelihood, mean VAF in %", 99.998, likelihood[vaf], note),
        Cell("its standard deviation", 0.0016, likelihood[spread], note, drawn=True),
        Cell("periodic MOESP, mean VAF in %", None, moesp[vaf], note),
        Cell("its standard deviation", None, moesp[spread], note),
        Cell(
            "eigenvalues inside the 95 % ellipse in %, mean of three", 93.7, sum(inside) / len(inside), note, drawn=True
        ),
    )
    command = f"python -m benchmarks.wind_turbine --runs {runs} --page FILE.html"
    return Paper("Goos2014", "Periodically varying state spaces", (Part("Figures 4 and 5", command, cells),))


def cox(runs: int) -> Paper:
    """Table 1: best fit rate and variance accounted for at five levels of noise, and the ratio of the times."""
    found = results("cox_study", "--runs", str(runs))
    cells = tuple(
        Cell(f"{row['method']}, {row['dB']} dB, {name} in %", row[paper], row[name], drawn=True)
        for row in found["table"]
        if row["method"] in ("reduced", "full", "reduced, refined")
        for name, paper in (("BFR mean", "paper's"), ("VAF mean", "paper's "))
    )
    times = next(one for one in found["times"] if (one["time of"], one["over that of"]) == ("full", "reduced"))
    cells += (
        Cell("time of the full realisation over the reduced", 7.04, times["median"], "17.47 s / 2.482 s", drawn=True),
    )
    text = f"{runs} runs, {OWN_SYSTEMS}. Refined: by maximum likelihood afterwards, which is ours."
    return Paper(
        "Cox2018",
        "Correlation analysis",
        (Part("Table 1", f"python -m benchmarks.cox_study --runs {runs}", cells, text=text),),
    )
