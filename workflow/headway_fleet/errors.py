# SPDX-License-Identifier: BSD-3-Clause
"""Errors that a user can remedy: reported as one line, exit status 1."""


class FleetError(Exception):
    """Input, configuration or environment is at fault; the text names file, cause and remedy."""
