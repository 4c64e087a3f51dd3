"""Flutter predictions from identified models, flutter summaries, and closed-loop stability."""
