"""Is it right: consistency statistics."""
