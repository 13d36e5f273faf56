"""The parameter of controllers that publish at a rate."""

from station.core.declared_parameter import DeclaredParameter, ParameterType

PUBLISH_RATE = DeclaredParameter(
    name="publish_rate",
    type=ParameterType.NUMBER,
    unit="Hz",
    description="rate of publication; 0: nothing is published",
)
