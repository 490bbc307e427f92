"""The catalogue of estimators, targets, spectrum families, basis functions and effects."""

from fastapi import APIRouter

from app.schemas.catalogue import Catalogue
from app.services.catalogue import catalogue

router = APIRouter(prefix="/catalogue", tags=["catalogue"])


@router.get("")
def get_catalogue() -> Catalogue:
    """What estimators, targets, spectrum families, basis functions and effects there are, with options and units."""
    return catalogue()
