"""The geometry that collides."""

from station.ui.scene.scene_views import CollisionLayer


def test_every_link_with_collision_geometry_shows_it(draw, node, panda):
    draw(CollisionLayer)
    for link, surface in panda.model.surfaces.items():
        drawn = node(f"{panda.node_of(link)}/collision")
        assert len(drawn.faces) == len(surface.faces)
