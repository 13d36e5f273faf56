"""Trajectories of joints, executed over any joint command interface.

One module per package of the original in which the class is called
`JointTrajectoryController`.
"""
