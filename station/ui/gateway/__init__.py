"""The only way into the dashboard: login, checks, and relays."""
