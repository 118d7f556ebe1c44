"""Start viser, without what it would do unasked."""

from __future__ import annotations

import contextlib
import io
import warnings

import viser


def start_viser() -> viser.ViserServer:
    """viser on a free port of this machine, unable to open a tunnel to the outside, and silent.

    A browser that leaves in the midst of an answer is nothing to warn of.
    """
    warnings.filterwarnings("ignore", message="Queued a .* on a closed connection")
    with contextlib.redirect_stdout(io.StringIO()):
        server = viser.ViserServer(host="127.0.0.1", port=0, label="Dynamic grasping", verbose=False)
    server.request_share_url = _refuse_to_share
    return server


def _refuse_to_share(verbose: bool = True) -> str | None:
    """Stands in for viser's own, which lets any client open a public tunnel."""
    return None
