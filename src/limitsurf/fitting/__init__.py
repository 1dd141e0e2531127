"""Limit surfaces fitted to measured loads and motions, as scikit-learn estimators."""
