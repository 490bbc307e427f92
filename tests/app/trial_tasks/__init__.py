"""Kinds of jobs for tests only; a server knows them by LPV_OED_TASK_PACKAGES."""
