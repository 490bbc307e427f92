"""What a force is called, depending on what the output is."""

from dataclasses import replace

from identification.channels import Channels
from identification.effects.library import library
from identification.places.motion import motions
from identification.places.nonlinear import Feedback
from identification.places.place import Effect

ORDERS = ("a position (or an angle, a charge)", "a speed (or a current)", "an acceleration")


def reading(effect: Effect, channels: Channels) -> str:
    """The effects that a force is by what the output may be, as "cubic stiffness if the output is a position …".

    Signals alone do not tell a spring on a position from a damper on a speed: f(q) with y = q and f(q̇) with y = q̇ are
    one function of y [Nayfeh1979, Section 2.3]. Empty for effects that act elsewhere and where the quantity of the
    output is stated.
    """
    if not isinstance(effect, Feedback) or channels.output.quantity is not None:
        return ""
    readings = [
        f"{one.title} if the output is {ORDERS[order]}"
        for order, driven in motions(channels)
        for one in library()
        if isinstance(one, Feedback) and replace(one, order=order, driven=driven).seen_as == effect.seen_as
    ]
    return ", ".join(readings)
