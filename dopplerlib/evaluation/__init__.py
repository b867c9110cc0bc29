"""Is it right? Consistency statistics."""
