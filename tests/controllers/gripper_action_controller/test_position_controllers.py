"""The gripper that commands positions."""


def test_it_claims_its_joint_for_position_commands(start):
    (claim,) = start().claims

    assert claim.hardware_interface == "hardware_interface::PositionJointInterface"
    assert claim.resources == ("slide",)
