"""Models as files for other programs."""

from app.conversion.misuse import pointing
from app.conversion.models import kept_model
from app.errors import UnprocessableError
from app.services.models import get, require_without_effects
from app.services.plants import get as get_plant
from app.store.resources import ResourceRepository
from identification.exports import exports


def as_file(resources: ResourceRepository, model_id: str, kind: str) -> tuple[bytes, str]:
    """The file of a model in the form of a kind of export, and its ending; raises UnprocessableError with why not."""
    if kind not in exports():
        raise UnprocessableError.at("/format", f"must be one of {', '.join(exports())}", "query")
    document = get(resources, model_id)
    require_without_effects(document, "/modelId", "path")
    export = exports()[kind]
    with pointing({}, "/format", "query"):
        model = kept_model(document, get_plant(resources, document.plant_id))
        return export.written(model).encode(), export.ending
