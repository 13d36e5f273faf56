"""The cycle that picks a command up."""

from station.core.ports.receipt import Receipt
from station.core.ports.set_point import SetPointElement, SetPointPort


def test_a_receipt_is_noted_on_when_the_set_point_is_taken():
    port = SetPointPort([SetPointElement("a", "rad")])
    receipt = Receipt(lambda: 7)
    port.post([0.1], receipt=receipt)
    assert receipt.cycle is None

    port.take()

    assert receipt.cycle == 7


def test_a_void_set_point_is_never_picked_up():
    port = SetPointPort([SetPointElement("a", "rad")])
    receipt = Receipt(lambda: 7)
    port.post([0.1], generation=port.generation - 1, receipt=receipt)

    assert port.take() is None
    assert receipt.cycle is None
