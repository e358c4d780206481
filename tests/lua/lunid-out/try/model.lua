-- a + k*y + c*v + coulomb_friction_Fc*sign(v) = F
local lunid = require "lunid"
local y, v, a, t, F = lunid.displacement, lunid.velocity, lunid.acceleration, lunid.time, lunid.force
local k = lunid.parameter { "k", 1.0002369567194036, min = 0, std = 0.00034858898822742425 }
local c = lunid.parameter { "c", 0.04877442245979121, min = 0, std = 0.0012602279146648092 }
local coulomb_friction_Fc = lunid.parameter { "coulomb_friction_Fc", 0.1304930477316522, min = 0, unit = "N", std = 0.0015819395311899344 }
return lunid.model {
  mass = 1,
  restoring = k*y + c*v + coulomb_friction_Fc*lunid.sign(v),
}
