"""What several policies share: instance sets, demonstrations, collisions and failed choices."""
