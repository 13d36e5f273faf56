# Every route of the API, with curl: lines to copy, in an order that works on a fresh
# station of the simulated Panda. A comment at the end of a line is the HTTP status of the
# answer, where it is not 200. docs/api.md says what to know about the routes.

API=http://127.0.0.1:8000/api/v1
TOKEN=…                                      # `station run` prints it
AUTH="Authorization: Bearer $TOKEN"
JSON="Content-Type: application/json"

# The first minute
curl -H "$AUTH" -H "$JSON" $API/controllers/switch -d '{"start": ["effort_group_position_controller"]}'
PIDS=$API/controllers/effort_group_position_controller
curl -H "$AUTH" -H "$JSON" -X PUT $PIDS/command -d '{"command": [0.3, -0.785, 0, -2.356, 0, 1.571, 0.785]}'

curl -H "$AUTH" $API/joint_states
curl -H "$AUTH" -H "$JSON" -X PATCH $PIDS/gains -d '{"values": {"panda_joint1/p": 100}}'
curl -H "$AUTH" $PIDS/state
curl -H "$AUTH" -H "$JSON" $API/controllers/switch -d '{"stop": ["effort_group_position_controller"]}'

# The station and its robot
curl $API/health
curl $API/ready
curl -H "$AUTH" $API/status
curl -H "$AUTH" $API/hardware
curl -H "$AUTH" $API/hardware/components
curl -H "$AUTH" -H "$JSON" -X PUT $API/hardware/components/panda/state -d '{"state": "active"}'

# Controllers
curl -H "$AUTH" $API/controllers
curl -H "$AUTH" $API/controller-types
curl -H "$AUTH" -H "$JSON" $API/controllers -d '{
  "name": "pose", "type": "position_controllers/JointGroupPositionController",
  "params": {"joints": ["panda_joint1", "panda_joint2", "panda_joint3", "panda_joint4",
                        "panda_joint5", "panda_joint6", "panda_joint7"]}}'                                 # 201
curl -H "$AUTH" $API/controllers/pose
curl -H "$AUTH" $API/controllers/chains
curl -H "$AUTH" -H "$JSON" $API/controllers/switch -d '{"start": ["pose"], "dry_run": true}'
curl -H "$AUTH" -H "$JSON" $API/controllers/switch -d '{"start": ["pose"]}'
curl -H "$AUTH" -H "$JSON" $API/controllers/switch -d '{"start": ["velocity_group_controller"]}'                  # 409

KEY="Idempotency-Key: 7c9e6679-7425"
curl -H "$AUTH" -H "$JSON" -H "$KEY" $API/controllers/switch -d '{"stop": ["pose"]}'
curl -H "$AUTH" -H "$JSON" -H "$KEY" $API/controllers/switch -d '{"stop": ["pose"]}'      # the same answer
curl -H "$AUTH" -H "$JSON" -H "$KEY" $API/controllers/switch -d '{"start": ["pose"]}'     # 422
curl -H "$AUTH" -H "$JSON" $API/controllers/switch -d '{"start": ["pose"]}'

# Set-points
curl -H "$AUTH" $API/controllers/pose/command
curl -H "$AUTH" -H "$JSON" -X PUT $API/controllers/pose/command -d '{"command": [0.01, -0.785, 0, -2.356, 0, 1.571, 0.785], "timeout": 0.5}'
curl -H "$AUTH" -H "$JSON" -X PUT $API/controllers/pose/command -d '{"command": [0.01]}'                          # 422
curl -H "$AUTH" $API/controllers/pose/state
curl -H "$AUTH" $API/joint_states

# Goals and trajectories
JTC=$API/controllers/position_joint_trajectory_controller
curl -H "$AUTH" -H "$JSON" $API/controllers/switch -d '{"stop": ["pose"], "start": ["position_joint_trajectory_controller"]}'
curl -H "$AUTH" -H "$JSON" $JTC/goals -d '{"goal": {"trajectory": {
  "joint_names": ["panda_joint1", "panda_joint2", "panda_joint3", "panda_joint4",
                  "panda_joint5", "panda_joint6", "panda_joint7"],
  "points": [{"positions": [0.1, -0.785, 0, -2.356, 0, 1.571, 0.785], "time_from_start": 2}]}}}'            # 201
GOAL=…                                       # the "id" of the answer
curl -H "$AUTH" $JTC/goals/$GOAL
curl -H "$AUTH" -X DELETE $JTC/goals/$GOAL
curl -H "$AUTH" $JTC/goals
curl -H "$AUTH" $JTC/query_state
curl -H "$AUTH" -H "$JSON" $JTC/trajectory -d '{"trajectory": {"points": [], "joint_names": [
  "panda_joint1", "panda_joint2", "panda_joint3", "panda_joint4", "panda_joint5", "panda_joint6", "panda_joint7"]}}'
curl -H "$AUTH" -H "$JSON" $API/controllers/switch -d '{"stop": ["position_joint_trajectory_controller"], "start": ["pose"]}'

curl -H "$AUTH" -X POST $API/waypoint-paths/wave/capture
curl -H "$AUTH" -H "$JSON" -X POST $API/waypoint-paths/wave/capture -d '{"name": "again", "duration": 1.5}'
curl -H "$AUTH" $API/waypoint-paths
curl -H "$AUTH" $API/waypoint-paths/wave
curl -H "$AUTH" -H "$JSON" -X PUT $API/waypoint-paths/wave -d '{"waypoints": [{"name": "up", "duration": 2.0, "positions": {"panda_joint1": 0.3}}]}'
curl -H "$AUTH" -H "$JSON" $API/controllers/switch -d '{"stop": ["pose"], "start": ["position_joint_trajectory_controller"]}'
curl -H "$AUTH" -H "$JSON" -X POST $API/waypoint-paths/wave/play -d '{"speed": 0.5, "loop": true}'
curl -H "$AUTH" -H "$JSON" -X PATCH $API/playback -d '{"paused": true}'
curl -H "$AUTH" $API/playback
curl -H "$AUTH" -X DELETE $API/playback
curl -H "$AUTH" -X DELETE $API/waypoint-paths/wave
curl -H "$AUTH" -H "$JSON" $API/controllers/switch -d '{"stop": ["position_joint_trajectory_controller"], "start": ["pose"]}'

# Gains
GAINS=$API/controllers/effort_group_position_controller/gains
curl -H "$AUTH" $GAINS
curl -H "$AUTH" -H "$JSON" -X PATCH $GAINS -d '{"values": {"panda_joint7/p": 80}}'
curl -H "$AUTH" -H "$JSON" -X PATCH -H 'If-Match: "an older one"' $GAINS -d '{"values": {"panda_joint7/p": 90}}'      # 412
curl -H "$AUTH" $API/controllers/effort_group_position_controller/config.yaml

curl -H "$AUTH" -X PUT $API/gain-sets/before
curl -H "$AUTH" -H "$JSON" -X PATCH $GAINS -d '{"values": {"panda_joint7/p": 70}}'
curl -H "$AUTH" $API/gain-sets
curl -H "$AUTH" $API/gain-sets/before
curl -H "$AUTH" -H "$JSON" -X POST $API/gain-sets/before/apply -d '{"controllers": ["effort_group_position_controller"]}'
curl -H "$AUTH" -X POST $API/gain-sets/undo
curl -H "$AUTH" -X DELETE $API/gain-sets/before
curl -H "$AUTH" -H "$JSON" -X PATCH $API/gains -d '{"changes": {
  "effort_group_position_controller": {"panda_joint7/p": 60},
  "effort_joint_trajectory_controller": {"panda_joint7/p": 60}}}'

# Response of a joint
BENCH=$API/controllers/pose/bench
curl -H "$AUTH" -H "$JSON" $BENCH -d '{"excitation": {"kind": "step", "joint": "panda_joint7", "amplitude": 0.1}, "duration": 0.8}'
curl -H "$AUTH" -H "$JSON" $BENCH -d '{"excitation": {"kind": "sine", "joint": "panda_joint7", "amplitude": 0.3, "frequency": 3}}'      # 422
curl -H "$AUTH" $API/bench-runs
curl -H "$AUTH" $API/bench-runs/step-1
curl -H "$AUTH" -X DELETE $API/bench-runs/step-1

# Lessons
curl -H "$AUTH" "$API/lessons?person=ada"
curl -H "$AUTH" -H "$JSON" $API/lessons/damping/begin -d '{"person": "ada"}'
curl -H "$AUTH" -H "$JSON" $API/lessons/damping/check -d '{"person": "ada", "answers": {}}'

# Experiments
EXPERIMENTS=$API/experiments
curl -H "$AUTH" -H "$JSON" $EXPERIMENTS -d '{"kind": "tune", "name": "softer",
  "controller": "effort_group_position_controller", "joints": ["panda_joint7"],
  "trials": 40, "duration": 0.5, "commands": [{"kind": "step", "joint": "panda_joint7", "amplitude": 0.05}]}'      # 201
curl -H "$AUTH" -H "$JSON" $EXPERIMENTS -d '{"kind": "robustness", "controller": "effort_group_position_controller"}'      # 409
curl -H "$AUTH" $EXPERIMENTS/softer
curl -H "$AUTH" -X POST $EXPERIMENTS/softer/cancel
curl -H "$AUTH" $EXPERIMENTS
curl -H "$AUTH" "$EXPERIMENTS/stiffer/trials?after=0&count=10"
curl -H "$AUTH" "$EXPERIMENTS/stiffer/best?metric=rms_error"
curl -H "$AUTH" $EXPERIMENTS/stiffer/responses
curl -H "$AUTH" $EXPERIMENTS/stiffer/preview
curl -H "$AUTH" -H "$JSON" $EXPERIMENTS/stiffer/apply -d '{"revisions": {"effort_group_position_controller": 99}}'      # 412
curl -H "$AUTH" -X POST $EXPERIMENTS/stiffer/apply
curl -H "$AUTH" -X POST $API/gain-sets/undo
curl -H "$AUTH" -X DELETE $EXPERIMENTS/stiffer

# Parameters and types
curl -H "$AUTH" $API/parameters
curl -H "$AUTH" -H "$JSON" -X PUT $API/parameters/soft/type -d '{"value": "position_controllers/JointGroupPositionController"}'
curl -H "$AUTH" $API/parameters/soft
curl -H "$AUTH" -H "$JSON" -X PUT $API/parameters/soft -d '{"value": {"joints": ["panda_joint1"]}}'
curl -H "$AUTH" -X DELETE $API/parameters/soft
curl -H "$AUTH" -X POST $API/controller-types/reload                    # 409

# Stop
curl -H "$AUTH" -H "$JSON" $API/stop -d '{"reason": "somebody is in the cell"}'
curl -H "$AUTH" $API/stop
curl -H "$AUTH" -H "$JSON" $API/controllers/switch -d '{"start": ["pose"]}'                                          # 423
curl -H "$AUTH" -X POST $API/stop/release
curl -H "$AUTH" -H "$JSON" $API/stop/release -d '{"arm": true}'
curl -H "$AUTH" -X DELETE $API/controllers/pose

# Simulation
curl -H "$AUTH" $API/scene
curl -H "$AUTH" -H "$JSON" -X PUT $API/scene/wall -d '{"type": "box", "size": [0.1, 1, 1], "position": [0.9, 0, 0.5], "role": "keep_out"}'
curl -H "$AUTH" -H "$JSON" -X POST $API/scene/wall/attach -d '{"arm": "panda"}'
curl -H "$AUTH" -X POST $API/scene/wall/detach
curl -H "$AUTH" -X PUT $API/scenes/cell
curl -H "$AUTH" $API/scenes
curl -H "$AUTH" $API/scenes/cell
curl -H "$AUTH" -X POST $API/scenes/cell/load
curl -H "$AUTH" -X DELETE $API/scenes/cell
curl -H "$AUTH" -X DELETE $API/scene/wall
curl -H "$AUTH" $API/simulation
curl -H "$AUTH" -H "$JSON" -X PATCH $API/simulation -d '{"paused": true}'
curl -H "$AUTH" -H "$JSON" $API/simulation/step -d '{"n": 100}'
curl -H "$AUTH" -H "$JSON" $API/simulation/reset -d '{"keyframe": "ready", "joint_positions": {"panda_joint1": 0.5}}'
curl -H "$AUTH" -H "$JSON" -X PATCH $API/simulation -d '{"paused": false, "real_time_factor": 1.0}'

# Cameras
curl -H "$AUTH" $API/cameras
curl -H "$AUTH" $API/cameras/cell --output cell.jpg             # 404: no camera is configured
curl -H "$AUTH" $API/cameras/cell/stream --output cell.mjpeg    # 404

# Arms
ARM=$API/robots/panda
curl -H "$AUTH" $API/robots
curl -H "$AUTH" $ARM/services
curl -H "$AUTH" $ARM/state
curl -H "$AUTH" "$ARM/model?frame=flange"
curl -H "$AUTH" $API/robots/left/state                                                                               # 404

curl -H "$AUTH" -H "$JSON" -X PUT $ARM/joint_impedance -d '{"joint_stiffness": [3000, 3000, 3000, 2500, 2500, 2000, 2000]}'
curl -H "$AUTH" -H "$JSON" -X PUT $ARM/joint_impedance -d '{"joint_stiffness": [-1, 0, 0, 0, 0, 0, 0]}'            # 422
curl -H "$AUTH" -H "$JSON" -X PUT $ARM/cartesian_impedance -d '{"cartesian_stiffness": [2000, 2000, 2000, 100, 100, 100]}'
curl -H "$AUTH" -H "$JSON" -X PUT $ARM/ee_frame -d '{"NE_T_EE": [1, 0, 0, 0,  0, 1, 0, 0,  0, 0, 1, 0,  0, 0, 0, 1]}'
curl -H "$AUTH" -H "$JSON" -X PUT $ARM/k_frame -d '{"EE_T_K": [1, 0, 0, 0,  0, 1, 0, 0,  0, 0, 1, 0,  0, 0, 0.05, 1]}'
curl -H "$AUTH" -H "$JSON" -X PUT $ARM/load -d '{
  "mass": 0.2, "F_x_center_load": [0, 0, 0.1], "load_inertia": [0.001, 0, 0,  0, 0.001, 0,  0, 0, 0.001]}'
curl -H "$AUTH" -H "$JSON" -X PUT $ARM/force_torque_collision_behavior -d '{
  "lower_torque_thresholds_nominal": [20, 20, 18, 18, 16, 14, 12], "upper_torque_thresholds_nominal": [40, 40, 36, 36, 32, 28, 24],
  "lower_force_thresholds_nominal": [20, 20, 20, 25, 25, 25], "upper_force_thresholds_nominal": [40, 40, 40, 50, 50, 50]}'
curl -H "$AUTH" -H "$JSON" -X PUT $ARM/full_collision_behavior -d '{
  "lower_torque_thresholds_acceleration": [20, 20, 18, 18, 16, 14, 12], "upper_torque_thresholds_acceleration": [40, 40, 36, 36, 32, 28, 24],
  "lower_torque_thresholds_nominal": [20, 20, 18, 18, 16, 14, 12], "upper_torque_thresholds_nominal": [40, 40, 36, 36, 32, 28, 24],
  "lower_force_thresholds_acceleration": [20, 20, 20, 25, 25, 25], "upper_force_thresholds_acceleration": [40, 40, 40, 50, 50, 50],
  "lower_force_thresholds_nominal": [20, 20, 20, 25, 25, 25], "upper_force_thresholds_nominal": [40, 40, 40, 50, 50, 50]}'

curl -H "$AUTH" -H "$JSON" $ARM/external_force -d '{"link": "panda_hand", "force": [0, 0, 5], "duration": 0.1}'
curl -H "$AUTH" -H "$JSON" $ARM/faults -d '{"kind": "collision", "cycles": 30}'
curl -H "$AUTH" $ARM/errors
curl -H "$AUTH" $ARM/contact_budget
curl -H "$AUTH" -H "$JSON" $ARM/user_stop -d '{"pressed": true}'
curl -H "$AUTH" -X POST $ARM/error_recovery                                                                          # 409
curl -H "$AUTH" -H "$JSON" $ARM/user_stop -d '{"pressed": false}'
curl -H "$AUTH" -H "$JSON" $ARM/error_recovery -d '{"restart": "none"}'
curl -H "$AUTH" $ARM/log
curl -H "$AUTH" -X POST $API/robots/error_recovery
curl -H "$AUTH" -H "$JSON" $ARM/external_force -d '{
  "link": "panda_hand", "force": [0, 0, 4], "frame": "panda_link0", "point": [0, 0, 0.1], "duration": 0.1}'
curl -H "$AUTH" -H "$JSON" $ARM/faults -d '{"kind": "stuck_joint", "joint": 4, "cycles": 100000}'
curl -H "$AUTH" $ARM/faults
curl -H "$AUTH" -X DELETE $ARM/faults
curl -H "$AUTH" -H "$JSON" $ARM/guiding -d '{"pressed": true}'
curl -H "$AUTH" -H "$JSON" $ARM/guiding -d '{"pressed": false}'
curl -H "$AUTH" -X POST $ARM/disconnect
curl -H "$AUTH" -X POST $ARM/connect
curl -H "$AUTH" -X POST $ARM/connect                                                                                 # 409

# Grippers
curl -H "$AUTH" $ARM/gripper
curl -H "$AUTH" -X POST $ARM/gripper/homing                                                                          # 202
curl -H "$AUTH" -H "$JSON" $ARM/gripper/move -d '{"width": 0.04, "speed": 0.1}'                                      # 202
curl -H "$AUTH" -H "$JSON" $ARM/gripper/grasp -d '{"width": 0.03, "force": 20, "epsilon": {"inner": 0.005, "outer": 0.01}}'  # 202
curl -H "$AUTH" -H "$JSON" $ARM/gripper/move -d '{"width": 0.2}'                                                     # 422
curl -H "$AUTH" -X POST $ARM/gripper/stop

# Loop
curl -H "$AUTH" -X POST $API/loop/statistics/reset
curl -H "$AUTH" $API/loop

# Control
curl -H "$AUTH" $API/control
curl -H "$AUTH" -H "$JSON" $API/control -d '{"owner": "ada", "ttl": 60}'
LEASE=…                                      # the "lease" of the answer
curl -H "$AUTH" -H "X-Control-Lease: $LEASE" -X POST $API/loop/statistics/reset
curl -H "$AUTH" -X POST $API/loop/statistics/reset                      # 423
curl -H "$AUTH" -H "$JSON" -H "X-Control-Lease: $LEASE" -X PATCH $API/control -d '{"hand_over_to": "grace"}'
curl -H "$AUTH" -H "X-Control-Lease: $LEASE" -X DELETE $API/control

# Tokens
curl -H "$AUTH" -H "$JSON" $API/tokens -d '{"name": "ada", "role": "viewer", "expires": 86400}'     # 201
curl -H "$AUTH" $API/tokens
curl -H "$AUTH" -X DELETE $API/tokens/ada

# Agents
curl -H "$AUTH" $API/agents/requests
curl -H "$AUTH" -H "$JSON" $API/agents/requests/5f0c81e09ab3 -d '{"verdict": "allowed"}'     # 404: no such request

# Events
curl -H "$AUTH" "$API/events?limit=20"
curl -H "$AUTH" "$API/events?since=7&kind=stop&kind=fault"
curl -H "$AUTH" "$API/events?severity=warning"

# Alarms
curl -H "$AUTH" $API/alarms
curl -H "$AUTH" -X POST $API/alarms/1000/acknowledge  # 404: no alarm has this number

# Plot layouts
curl -H "$AUTH" -H "$JSON" -X PUT $API/plot-layouts/torques -d '{"plots": [{"keys": ["effort/panda_joint1", "effort/panda_joint2"], "transform": "smooth"}]}'
curl -H "$AUTH" $API/plot-layouts
curl -H "$AUTH" $API/plot-layouts/torques
curl -H "$AUTH" -X DELETE $API/plot-layouts/torques

# Rehearsals
curl -H "$AUTH" -H "$JSON" -X POST $API/rehearse -d '{"steps": [{"kind": "switch", "start": ["pose"]}], "seconds": 0.5}'

curl -H "$AUTH" -H "$JSON" -X POST $API/plan -d '{"controller": "arm", "positions": {"panda_joint1": 0.5}}'   # 404
curl -H "$AUTH" -H "$JSON" -X POST $API/plan -d '{"controller": "arm", "pose": {"position": [0.4, 0.1, 0.5], "orientation": [1, 0, 0, 0]}}'   # 404

# Recordings and incidents
curl -H "$AUTH" -H "$JSON" -X POST $API/recordings -d '{"name": "walk", "note": "the heavy cube"}'   # 201
curl -H "$AUTH" $API/recordings
curl -H "$AUTH" $API/recordings/20261122T091500123-walk
curl -H "$AUTH" -X POST $API/recordings/20261122T091500123-walk/stop
curl -H "$AUTH" -o walk.mcap $API/recordings/20261122T091500123-walk/file
curl -H "$AUTH" "$API/recordings/20261122T091500123-walk/trajectory?rate=10"
curl -H "$AUTH" -o walk.csv "$API/recordings/20261122T091500123-walk/table?channels=joint_states/position&channels=commands&joints=panda_joint1&rate=100"
curl -H "$AUTH" $API/recordings/20261122T091500123-walk/events
curl -H "$AUTH" -H "Content-Type: application/octet-stream" --data-binary @walk.mcap "$API/recordings/upload?name=tuesday"   # 201
curl -H "$AUTH" -H "$JSON" -X POST $API/recordings/walk/notes -d '{"text": "It slipped.", "time": 3603.5, "until": 3604.25}'   # 409 beyond its times
curl -H "$AUTH" -H "$JSON" $API/recordings/20261122T091500123-walk/bench -d '{"controller": "pose", "joint": "panda_joint1", "kind": "step", "end": 0.001}'   # 409 with less than two cycles
curl -H "$AUTH" -X DELETE $API/recordings/20261122T091500123-walk
curl -H "$AUTH" $API/incidents
curl -H "$AUTH" $API/incidents/20261122T091500123-incident
curl -H "$AUTH" -o incident.mcap $API/incidents/20261122T091500123-incident/file
curl -H "$AUTH" $API/incidents/20261122T091500123-incident/trajectory
curl -H "$AUTH" "$API/incidents/20261122T091500123-incident/table?rate=100"
curl -H "$AUTH" $API/incidents/20261122T091500123-incident/events
curl -H "$AUTH" -H "$JSON" -X POST $API/incidents/20261122T091500123-incident/notes -d '{"text": "It caught.", "time": 3600.5}'   # 409 beyond its times
curl -H "$AUTH" -H "$JSON" $API/incidents/20261122T091500123-incident/bench -d '{"controller": "pose", "joint": "panda_joint1", "kind": "step", "end": 0.001}'   # 409 with less than two cycles

# Answers
curl -H "$AUTH" -H "If-None-Match: *" $API/stop                            # 304

# Access
curl $API/status                                                        # 401
curl -H "$AUTH" $API/session
curl -H "$JSON" $API/login -d "{\"token\": \"$TOKEN\"}"
curl -X POST $API/logout                                                # 204
curl -H "$AUTH" -X POST $API/stream-tickets

# Streams
curl -H "$AUTH" $API/streams/joint_states                               # 426
