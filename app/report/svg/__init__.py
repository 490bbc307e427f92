"""Figures drawn as SVG without a script: they print as they look, and weigh what their data weigh."""
