"""Routes of the agents' requests: what waits, and a person's answer."""

from fastapi import APIRouter, Request

from station.api.audit import origin_of
from station.api.dependencies import OperatorAnyway, ServicesDep, Viewer
from station.api.json_route import JsonRoute
from station.api.routes.problems import problems
from station.reports import AgentRequest, Verdict
from station.wire import AgentAnswer, AgentRequests

router = APIRouter(
    prefix="/agents/requests",
    tags=["control"],
    dependencies=[Viewer],
    route_class=JsonRoute,
)


@router.get("", responses=problems())
async def list_agent_requests(services: ServicesDep) -> AgentRequests:
    """List the latest requests of agents, oldest first.

    Those that wait for an answer have no `verdict`.
    """
    return AgentRequests(requests=services.agents.requests())


@router.post(
    "/{number}", dependencies=[OperatorAnyway], responses=problems(404, 409, 413, 422)
)
async def answer_agent(
    number: str, answer: AgentAnswer, services: ServicesDep, connection: Request
) -> AgentRequest:
    """Allow or refuse what an agent asks for; only a person can.

    The answer takes no control from the agent. A request that nobody answers in time is
    refused.
    """
    return services.agents.decide(
        number, Verdict(answer.verdict), origin_of(connection)
    )
