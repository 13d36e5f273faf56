"""Pick a cube and survive a reflex; `station run examples/cube.yaml` first."""

from station.client import ApiError, Pose, StationClient
from station.wire import ExternalForce

PUSH = ExternalForce(link="panda_link5", force=[0.0, 150.0, 0.0], duration=0.2)

with StationClient() as station:
    station.move_to("ready")
    arm = station.robot()
    arm.gripper.open()
    for x, y, z in ((0.5, 0.0, 0.2), (0.5, 0.0, 0.02)):
        station.move_to(Pose((x, y, z), (1.0, 0.0, 0.0, 0.0)))
    print(f"width of what is held: {1000.0 * arm.gripper.close().width:.0f} mm")
    arm.apply_force(PUSH)
    for x, y, z in ((0.5, 0.0, 0.3), (0.4, 0.3, 0.3), (0.4, 0.3, 0.03)):
        try:
            station.move_to(Pose((x, y, z), (1.0, 0.0, 0.0, 0.0)))
        except ApiError as reason:  # the reflex has stopped the controller
            print(reason)
            arm.recover()
            station.move_to(Pose((x, y, z), (1.0, 0.0, 0.0, 0.0)))
    arm.gripper.open()
    print("the cube is at", [round(q or 0.0, 2) for q in station.scene()[0].position])
