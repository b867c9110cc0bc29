# Made by python -m tools.stubs; do not edit.
from . import claims as claims
from . import deviations as deviations
from . import documents as documents
from . import interval_table as interval_table
from . import published as published
from . import readings as readings
from . import scorecard as scorecard
from . import verdicts as verdicts
