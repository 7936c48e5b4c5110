# SPDX-License-Identifier: Apache-2.0
"""Rates of events, of one clip and of groups of clips, and whether they differ: estimates as (mean, low, high)."""
from ._native import compare_groups, compare_rates, event_rate, group_rate

__all__ = ["compare_groups", "compare_rates", "event_rate", "group_rate"]
