"""Serve the dashboard: ``python run_server.py``, then open the address it prints."""

import os
import signal
import socket
import sys

from app.settings import Settings, read_settings
from backend.errors import GraspingError, InvalidInputError


def main() -> int:
    """Exit code: 0 after Ctrl-C, 2 for settings that cannot be used."""
    try:
        settings = read_settings(sys.argv[1:], os.environ)
        listener = listen(settings)
        from app.serve import serve

        serve(settings, listener)
    except GraspingError as error:
        print(error, file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("Stopped.")
    return 0


def listen(settings: Settings) -> socket.socket:
    """The bound socket; raises ``InvalidInputError`` saying what to do when the port cannot be had."""
    family = socket.AF_INET6 if ":" in settings.host else socket.AF_INET
    listener = socket.socket(family)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listener.bind((settings.host, settings.port))
        listener.listen(128)
    except OSError as error:
        listener.close()
        raise InvalidInputError(
            f"Cannot listen on {settings.host} port {settings.port}: {error.strerror}. "
            "Stop what uses it, or choose another port with --port (0 takes any free one)."
        ) from None
    return listener


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    sys.exit(main())
