"""What the layers of the 3D view have in common."""

from station.ui.layers.collision_layer import CollisionLayer


def test_a_layer_that_is_removed_leaves_nothing_in_the_scene(draw, node):
    layer = draw(CollisionLayer)
    paths = [one.name for one in layer.nodes]
    assert all(node(path) is not None for path in paths)
    layer.remove()
    assert all(node(path) is None for path in paths)
    assert layer.nodes == []
