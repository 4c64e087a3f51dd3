"""Live identification: streams, their processing, and alarms."""
