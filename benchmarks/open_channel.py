"""The open channel: models of order 10 over the position, at the five measured positions and four others.

python -m benchmarks.open_channel [--order 10] [--output FILE.json] [--page FILE.html]
"""

import time
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.command import command_line, write_json
from examples.open_channel import BETWEEN, FREQUENCIES, MEASURED, OpenChannel, delay_free_responses
from identification.bases.chebyshev import Chebyshev
from identification.parametric.estimate import overall_error, response_errors
from identification.parametric.parametric_subspace import ParametricSubspace
from identification.parametric.state_space_likelihood import StateSpaceLikelihood
from identification.pole_regions.half_plane import HalfPlane
from identification.pole_regions.inequality import PoleRegion
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable

POSITION = SchedulingVariable("x", "m", 100.0, 15400.0)
BLOCK_ROWS = (2, 4, 6, 10, 15, 20)  # beyond the order
REGION = HalfPlane(1e-7)  # rad/s: the channel integrates, so that its slowest pole lies on the border of stability


def dependence(*degrees: int) -> ParameterDependence:
    """Polynomials of these degrees in x for A, B, C and D."""
    return ParameterDependence((POSITION,), tuple(ProductBasis((Chebyshev(k),)) for k in degrees))


def fitted(order: int, region: PoleRegion | None, degrees: tuple[int, ...]) -> tuple[Any, float]:
    """The model with the least misfit over some numbers of block rows, and the seconds of computing it took."""
    data = delay_free_responses(OpenChannel())
    start, found = time.process_time(), []
    for rows in BLOCK_ROWS:
        method = ParametricSubspace(order, order + rows, region=region, margin=1e-9)
        model = method.estimate(dependence(*degrees), data).model
        found.append((overall_error(model, data), rows, model))
    return min(found, key=lambda item: item[:2])[2], (time.process_time() - start) / len(BLOCK_ROWS)


def models(order: int) -> dict[str, Any]:
    """The parametric models, and how long each took."""
    found = {}
    for name, degrees in (("affine", (1, 1, 1, 1)), ("A, C constant, B, D quadratic", (0, 2, 0, 2))):
        for number, region in ((1, None), (2, REGION)):
            found[f"{name}, Algorithm {number}"] = fitted(order, region, degrees)
    start = time.process_time()
    refined = StateSpaceLikelihood(HalfPlane(2e-7), margin=1e-8, rounds=3)
    last = list(found.values())[-1][0]
    model = refined.estimate(last, delay_free_responses(OpenChannel())).model
    found["… refined by least squares"] = model, time.process_time() - start
    return found


def floor(order: int) -> list[float]:
    """Relative errors of a model of its own at each measured position: what the order alone costs."""
    methods, constant = [ParametricSubspace(order, order + rows) for rows in BLOCK_ROWS], dependence(0, 0, 0, 0)
    every = delay_free_responses(OpenChannel())
    return [min(method.estimate(constant, [data]).errors[0].relative for method in methods) for data in every]


def table(found: dict[str, Any]) -> dict[str, Any]:
    """Relative errors of every model at all nine positions, the largest real part of its poles, and its time."""
    channel, rows = OpenChannel(), {}
    everywhere = np.linspace(POSITION.minimum, POSITION.maximum, 1001)[:, None]
    for name, (model, seconds) in found.items():
        rows[name] = {
            "measured": [e.relative for e in response_errors(model, delay_free_responses(channel, MEASURED))],
            "between": [e.relative for e in response_errors(model, delay_free_responses(channel, BETWEEN))],
            "largestRealPart": float(model.poles(everywhere).real.max()),
            "seconds": seconds,
        }
    return rows


def picture(found: dict[str, Any], names: tuple[str, ...], page: Path) -> None:
    """|H| over ω as in [Kergus2019, Fig. 3]: measured positions green, others red, the channel itself dashed."""
    from plotly.subplots import make_subplots

    channel = OpenChannel()
    titles = [f"{name}: {signal}" for name in names for signal in ("entering discharge", "leaving discharge")]
    figure = make_subplots(rows=len(names), cols=2, subplot_titles=titles)
    for row, name in enumerate(names, 1):
        for x in sorted(MEASURED + BETWEEN):
            truth = channel.response(x, FREQUENCIES, without_delays=True)
            model = found[name][0].frequency_response([[x]], FREQUENCIES)[0, :, 0, 0]
            for u in range(2):
                colour, label = ("green", "measured") if x in MEASURED else ("red", "between")
                for values, line in ((model, {"color": colour}), (truth, {"color": "blue", "dash": "dash"})):
                    figure.add_scatter(
                        x=FREQUENCIES,
                        y=20 * np.log10(abs(values[:, 0, u])),
                        line={**line, "width": 1},
                        name=f"x = {x:g} m ({label if values is model else 'channel'})",
                        showlegend=row == 1 and u == 0,
                        row=row,
                        col=u + 1,
                    )
    figure.update_xaxes(type="log", title="ω in rad/s")
    figure.update_yaxes(title="dB re 1 m/(m³/s)")
    figure.update_layout(height=500 * len(names), title="Delay-free channel and models of its level over position")
    figure.write_html(page, include_plotlyjs=True)


def main() -> None:
    """Print the table of errors, and write it and the picture."""
    parser = command_line(__doc__, page=True)
    parser.add_argument("--order", type=int, default=10)
    arguments = parser.parse_args()
    found = models(arguments.order)
    rows, own = table(found), floor(arguments.order)
    channel = OpenChannel()
    print(f"y0 = {channel.depth:.3f} m, V0 = {channel.velocity:.3f} m/s, c0 = {channel.celerity:.3f} m/s")
    print(f"{'relative error at x in m':44s}", *(f"{x:7g}" for x in MEASURED + BETWEEN))
    print(f"{'a model of its own at each position':44s}", *(f"{e:7.3f}" for e in own))
    for name, row in rows.items():
        errors = " ".join(f"{e:7.3f}" for e in row["measured"] + row["between"])
        print(f"{name:44s} {errors}   max Re s {row['largestRealPart']:9.2e}   {row['seconds']:.2f} s")
    geometry = {"depth": channel.depth, "velocity": channel.velocity, "celerity": channel.celerity}
    write_json({"channel": {**vars(channel), **geometry}, "own": own, "models": rows}, arguments.output)
    if arguments.page:
        names = ("affine, Algorithm 1", "affine, Algorithm 2", "… refined by least squares")
        picture(found, names, arguments.page)


if __name__ == "__main__":
    main()
