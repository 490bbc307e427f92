"""The lightly damped structure of order 42 on 512 lines at 200 Hz: McKelvey 1 and 2, Levy, and Gauss–Newton from Levy.

python -m benchmarks.subspace_structure [--noise 0.01] [--max-order 60] [--output FILE] [--page FILE.html]

Every model is estimated twice: from all lines, and from every second line, to be judged on the lines between them
[Akcay2008, A comparison study; Model Order Determination].
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from benchmarks.command import command_line, write_json
from examples.lightly_damped_structure import SAMPLE_TIME, response, structure
from identification.arrays import ComplexArray, FloatArray
from identification.least_squares import levenberg_marquardt
from identification.lti.likelihood import response_errors
from identification.lti.rational_start import levy
from identification.models.rational import RationalStructure
from identification.signals import FrequencyResponse
from identification.subspace.equidistant_subspace import EquidistantSubspace
from identification.subspace.frequency_subspace import FrequencySubspace

ORDER = 42
RATIONAL = RationalStructure(ORDER, ORDER, sample_time=SAMPLE_TIME)

Model = tuple[Callable[[FloatArray], ComplexArray], bool]


def main() -> None:
    """Print the table of the four methods, write the figures as JSON and as a picture."""
    parser = command_line(__doc__, page=True)
    parser.add_argument("--noise", type=float, default=0.01)
    parser.add_argument("--max-order", type=int, default=60)
    arguments = parser.parse_args()
    data = response(arguments.noise)
    rows, models = compare(data)
    print(f"{len(data)} lines, order {ORDER}, noise {np.sqrt(data.variance[0]):.4f} a line (root mean square)")
    print("method                        all lines: rms, max      every second line, on the others: rms, max    stable")
    for row in rows:
        print(
            f"{row['method']:28s} {row['rms']:9.4f} {row['max']:9.4f}      {row['heldOutRms']:15.4f}"
            f" {row['heldOutMax']:9.4f}   {'yes' if row['stable'] else 'no':>20s}"
        )
    orders = orders_of(data, arguments.max_order)
    print(f"order chosen by the error on held-out lines: {orders['chosen']}")
    result = {"noise": float(np.sqrt(data.variance[0])), "methods": rows, "orders": orders}
    write_json(result, arguments.output)
    if arguments.page:
        picture(data, models, orders).write_html(arguments.page, include_plotlyjs=True)


def subspace_model(method: EquidistantSubspace | FrequencySubspace, data: FrequencyResponse) -> Model:
    """A state-space model as a function of the frequency, and whether it is stable."""
    model = method.estimate(data).model
    return lambda omega: model.frequency_response(omega)[:, 0, 0], bool(model.stable)


def levy_model(data: FrequencyResponse) -> Model:
    """Levy's linear fit."""
    return rational_model(levy(RATIONAL, data))


def gauss_newton_model(data: FrequencyResponse) -> Model:
    """The nonlinear least-squares fit from Levy's."""
    weights = np.ones(len(data))
    found = levenberg_marquardt(lambda zeta: response_errors(RATIONAL, zeta, data, weights), levy(RATIONAL, data))
    return rational_model(found.x)


def rational_model(zeta: FloatArray) -> Model:
    """A rational model as a function of the frequency, and whether it is stable."""
    return lambda omega: RATIONAL.plant_response(zeta, omega), bool(RATIONAL.stable(zeta))


METHODS: dict[str, Callable[[FrequencyResponse], Model]] = {
    "McKelvey 1": lambda data: subspace_model(EquidistantSubspace(order=ORDER, stability="projection"), data),
    "McKelvey 2": lambda data: subspace_model(FrequencySubspace(order=ORDER, stability="projection"), data),
    "McKelvey 2, Maciejowski": lambda data: subspace_model(
        FrequencySubspace(order=ORDER, stability="maciejowski"), data
    ),
    "Levy": levy_model,
    "Gauss–Newton from Levy": gauss_newton_model,
}


def compare(data: FrequencyResponse) -> tuple[list[dict[str, Any]], dict[str, ComplexArray]]:
    """Errors of each method on all lines and on held-out lines, and its response on all lines."""
    used, held_out = data.lines(slice(0, None, 2)), data.lines(slice(1, None, 2))
    rows, responses = [], {}
    for name, method in METHODS.items():
        model, stable = method(data)
        half, half_stable = method(used)
        responses[name] = model(data.frequencies)
        error, other = abs(responses[name] - data.response), abs(half(held_out.frequencies) - held_out.response)
        rows.append(
            {
                "method": name,
                "rms": float(np.sqrt(np.mean(error**2))),
                "max": float(error.max()),
                "heldOutRms": float(np.sqrt(np.mean(other**2))),
                "heldOutMax": float(other.max()),
                "stable": stable and half_stable,
            }
        )
    return rows, responses


def orders_of(data: FrequencyResponse, highest: int) -> dict[str, Any]:
    """The tables of orders of both subspace methods, and the orders that they and the singular values choose."""
    first = EquidistantSubspace(max_order=highest, stability="projection").estimate(data)
    second = FrequencySubspace(max_order=highest, stability="projection").estimate(data)
    tables = {
        name: [vars(trial) for trial in found.orders] for name, found in (("McKelvey 1", first), ("McKelvey 2", second))
    }
    gap = FrequencySubspace(max_order=highest, order_rule="singular_values").estimate(data)
    chosen = {"McKelvey 1": first.model.order, "McKelvey 2": second.model.order, "singular values": gap.model.order}
    return {"chosen": chosen, "tables": tables}


def picture(data: FrequencyResponse, models: dict[str, ComplexArray], orders: dict[str, Any]) -> go.Figure:
    """The response with the model of McKelvey 1, the errors of all methods, and the errors against the order."""
    titles = ("Response and model of order 42", "Errors", "Error on held-out lines against the order")
    figure = make_subplots(rows=3, cols=1, subplot_titles=titles)
    hertz = data.frequencies / 2 / np.pi
    fine = np.linspace(0, np.pi / SAMPLE_TIME, 4096)
    truth = abs(structure().frequency_response(fine)[:, 0, 0])
    figure.add_scatter(x=fine / 2 / np.pi, y=truth, name="structure", line={"color": "lightgrey"}, row=1, col=1)
    figure.add_scatter(x=hertz, y=abs(data.response), name="measured", mode="markers", marker={"size": 3}, row=1, col=1)
    figure.add_scatter(x=hertz, y=abs(models["McKelvey 1"]), name="McKelvey 1", row=1, col=1)
    for name, values in models.items():
        figure.add_scatter(x=hertz, y=abs(values - data.response), name=f"error, {name}", row=2, col=1)
    for name, trials in orders["tables"].items():
        x, y = [t["order"] for t in trials], [t["held_out_rms_error"] for t in trials]
        figure.add_scatter(x=x, y=y, name=f"held out, {name}", mode="lines+markers", row=3, col=1)
    figure.update_yaxes(type="log", exponentformat="power")
    for row, title in ((1, "frequency, Hz"), (2, "frequency, Hz"), (3, "order")):
        figure.update_xaxes(title=title, row=row, col=1)
    figure.update_layout(template="plotly_white", height=1200)
    return figure


if __name__ == "__main__":
    main()
