"""Recordings of IRIG 106 Chapter 10 (11 since 2017), the format of flight-test recorders."""
