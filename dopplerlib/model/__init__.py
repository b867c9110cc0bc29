"""The world as numbers: sensors, Doppler shift, motion, scenarios, simulation."""
