"""A first policy for kitchen_prefs; importing it registers `--policy.type=deepsets`."""

from . import configuration_deepsets, modeling_deepsets, processor_deepsets  # noqa: F401
