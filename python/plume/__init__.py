"""Procedural caves, mines and lava tubes for robot simulators."""

from plume._plume import __version__

__all__ = ["__version__"]
