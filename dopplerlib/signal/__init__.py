"""From a moving target to IQ samples, and from IQ samples to Doppler shifts."""
