# Made by python -m tools.stubs; do not edit.
from . import choices as choices
from . import claims as claims
from . import deviations as deviations
from . import documents as documents
from . import evidence as evidence
from . import interval_table as interval_table
from . import judgments as judgments
from . import published as published
from . import scorecard as scorecard
from . import sentences as sentences
from . import verdicts as verdicts
