# Made by python -m tools.stubs; do not edit.
from . import extended_kalman as extended_kalman
from . import extended_update as extended_update
from . import gaussian as gaussian
from . import imm as imm
from . import imm_records as imm_records
from . import linear_kalman as linear_kalman
from . import maximum_likelihood as maximum_likelihood
from . import models as models
from . import nonlinear_kalman as nonlinear_kalman
from . import radial_velocity as radial_velocity
from . import recursion as recursion
from . import sigma_points as sigma_points
from . import smoother as smoother
from . import steady_state as steady_state
from . import track as track
from . import variable_projection as variable_projection
