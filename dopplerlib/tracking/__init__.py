"""Many detections and many targets: gates, association, and the life of a track."""
