"""The cycle that picks a command up."""

from station.core.ports.command_ticket import CommandTicket
from station.core.ports.set_point import SetPointElement, SetPointPort


def test_a_ticket_is_noted_on_when_the_set_point_is_taken():
    port = SetPointPort([SetPointElement("a", "rad")])
    ticket = CommandTicket(lambda: 7)
    port.post([0.1], ticket=ticket)
    assert ticket.accepted_cycle is None

    port.take()

    assert ticket.accepted_cycle == 7


def test_a_void_set_point_is_never_picked_up():
    port = SetPointPort([SetPointElement("a", "rad")])
    ticket = CommandTicket(lambda: 7)
    port.post([0.1], generation=port.generation - 1, ticket=ticket)

    assert port.take() is None
    assert ticket.accepted_cycle is None
