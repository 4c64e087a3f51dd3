"""Public names of the library, once: they are promised, and loaded when they are first used."""

from .estimation.estimate import Estimate as Estimate
from .estimation.experiment import select_parameters as select_parameters
from .estimation.frequency_response_error import (
    frequency_response_error as frequency_response_error,
)
from .estimation.likelihood import FitSettings as FitSettings
from .estimation.likelihood import maximize as maximize
from .estimation.output_error import output_error as output_error
from .excitation.multisine import assign_harmonics as assign_harmonics
from .excitation.multisine import design_multisine as design_multisine
from .grey_box.fit import GreyBoxData as GreyBoxData
from .grey_box.fit import GreyBoxEstimate as GreyBoxEstimate
from .grey_box.fit import fit_grey_box as fit_grey_box
from .grey_box.model import GreyBox as GreyBox
from .grey_box.model import GreyBoxParameter as GreyBoxParameter
from .grey_box.python_control import (
    fit_frequency_response_data as fit_frequency_response_data,
)
from .model.aeroelastic import AeroelasticModel as AeroelasticModel
from .model.aeroelastic import StateSpace as StateSpace
from .model.airspeed import AIRSPEED as AIRSPEED
from .model.condition import FlightCondition as FlightCondition
from .model.derivatives import DerivativeTable as DerivativeTable
from .model.lateral import LATERAL as LATERAL
from .model.longitudinal import LONGITUDINAL as LONGITUDINAL
from .model.longitudinal import accelerometer_row as accelerometer_row
from .model.longitudinal import attitude_row as attitude_row
from .model.longitudinal import gyro_row as gyro_row
from .model.longitudinal import vane_row as vane_row
from .model.reduction import time_response as time_response
from .model.rigid_body import stack_rows as stack_rows
from .model.rigid_body import strain_row as strain_row
from .model.sensor_models import Instrument as Instrument
from .modes.shapes import StructuralModes as StructuralModes
from .regression.equation_error import equation_error as equation_error
from .signals import FrequencyData as FrequencyData
from .signals import FrequencyResponse as FrequencyResponse
from .signals import TimeHistory as TimeHistory
from .spectra.fourier import finite_fourier_transform as finite_fourier_transform
from .spectra.response import estimate_bare_airframe_responses as estimate_bare_airframe_responses
from .stability.poles import Aeroelastic as Aeroelastic
from .stability.root_tracking import track_roots as track_roots
