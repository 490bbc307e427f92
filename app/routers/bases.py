"""Basis functions, to be looked at."""

from fastapi import APIRouter

from app.schemas.bases import BasisValues, BasisValuesRequest
from app.services import bases

router = APIRouter(prefix="/bases", tags=["catalogue"])


@router.post("/values")
def evaluate_basis(body: BasisValuesRequest) -> BasisValues:
    """The functions of a basis over the range of the scheduling variables; nothing is kept."""
    return bases.values(body)
