"""Curves of one piece of an arm: a cell, the clamped end or the free end."""
