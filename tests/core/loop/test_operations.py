"""What other threads want done between two cycles."""

from station.core.errors import LoopError
from station.core.loop.operations import OPERATIONS_PER_CYCLE, Operations


def test_what_is_posted_is_run_once_and_its_result_handed_over():
    operations = Operations()
    operation = operations.post(lambda: 7)

    assert operations.run_operations()

    assert operation.done.acquire(blocking=False)
    assert (operation.result, operation.error) == (7, None)
    assert not operations.run_operations()


def test_an_error_is_handed_over_instead_of_raised():
    operations = Operations()
    operation = operations.post(lambda: 1 / 0)

    operations.run_operations()

    assert isinstance(operation.error, ZeroDivisionError)


def test_a_cycle_runs_a_few_only():
    operations, ran = Operations(), []
    for number in range(OPERATIONS_PER_CYCLE + 1):
        operations.post(lambda number=number: ran.append(number))

    operations.run_operations()
    assert ran == list(range(OPERATIONS_PER_CYCLE))
    operations.run_operations()
    assert ran[-1] == OPERATIONS_PER_CYCLE


def test_what_nobody_waits_for_is_not_run():
    operations, ran = Operations(), []
    operations.post(lambda: ran.append(1)).abandoned = True

    operations.run_operations()

    assert ran == []


def test_who_waits_is_told_when_nobody_will_run_it():
    operations = Operations()
    operation = operations.post(lambda: 7)

    operations.give_up(LoopError("dead"))

    assert operation.done.acquire(blocking=False)
    assert str(operation.error) == "dead"
    assert not operations.run_operations()
