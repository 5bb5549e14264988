# SPDX-License-Identifier: BSD-3-Clause
"""A folder or list of recordings to one page: what workflow/Snakefile and headway-fleet run."""
