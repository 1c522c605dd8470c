"""Estimators of a pair of sensors on recordings and rendered rooms whose truth is known."""
