-- a + k*y + c*v + sinusoidal_stiffness_k*sin(sinusoidal_stiffness_p*y) = F
local lunid = require "lunid"
local y, v, a, t, F = lunid.displacement, lunid.velocity, lunid.acceleration, lunid.time, lunid.force
local k = lunid.parameter { "k", 1.0000057201525832, min = 0, std = 2.683676246453128e-5 }
local c = lunid.parameter { "c", 0.059998338365433765, min = 0, std = 1.70746188586471e-5 }
local sinusoidal_stiffness_k = lunid.parameter { "sinusoidal_stiffness_k", 0.800097304945807, unit = "N", std = 0.00016065252726191363 }
local sinusoidal_stiffness_p = lunid.parameter { "sinusoidal_stiffness_p", 4.000040101535878, min = 0.11253869274907195, max = 45.01547709962878, unit = "1/m", std = 0.00015522964180424327 }
return lunid.model {
  mass = 1,
  restoring = k*y + c*v + sinusoidal_stiffness_k*lunid.sin(sinusoidal_stiffness_p*y),
}
