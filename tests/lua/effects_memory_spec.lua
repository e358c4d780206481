-- Entries with memory against independent references along imposed motions: return mapping in small steps, closed forms of
-- loops and moduli, the rules of Masing with a stack of reversals, and Baber and Noori by a hand-written integrator.
local lunid = require "lunid"
local spec = require "spec"

local y, v, t = lunid.displacement, lunid.velocity, lunid.time
local effects, pi = lunid.effects, math.pi

--- A motion: the sum of A sin(w t) over rows { A, w }, and slope*t. As an expression and as numbers y, v, a.
local function motion(rows, slope)
  local path = (slope or 0)*t
  for _, row in ipairs(rows) do path = path + row[1]*lunid.sin(row[2]*t) end
  return { path = path, at = function(now)
    local y, v, a = (slope or 0)*now, slope or 0, 0
    for _, row in ipairs(rows) do
      local A, w = row[1], row[2]
      local s = math.sin(w*now)
      y, v, a = y + A*s, v + A*w*math.cos(w*now), a - A*w^2*s
    end
    return y, v, a
  end }
end

--- The motion y(t), an expression, as a record of y, v and a.
local function record_of(path, duration, dt)
  local speed = path:derivative(t)
  return lunid.simulate { model = lunid.model { mass = 1, restoring = 0 }, excitation = speed:derivative(t),
    from = { path:at { t = 0 }, speed:at { t = 0 } }, duration = duration, dt = dt, solver = "fixed", substeps = 4 }:record()
end

--- The force of an element along a record.
local function force_of(element, record)
  return lunid.model { mass = 0, restoring = element, motion = "imposed" }:force(record)
end

--- The same by a rule step(y, v, a, h) -> force, called along the motion in `fine` parts of each sample.
local function by_rule(along, record, fine, step)
  local forces, h = {}, record.dt / fine
  for i = 1, record.rows do
    for j = (i == 1 and fine or 1), fine do
      local y, v, a = along.at(((i - 2) * fine + j) * h)
      forces[i] = step(y, v, a, i == 1 and 0 or h)
    end
  end
  return forces
end

local function clip(x, low, high) return math.max(low, math.min(high, x)) end

--- The element and the rule agree within `tolerance` of the largest force.
local function compare(element, along, duration, rule, tolerance, fine)
  local record = record_of(along.path, duration, 0.004)
  local got, expected = force_of(element, record), by_rule(along, record, fine or 40, rule)
  local largest, worst, at = 0, 0, 0
  for i = 1, record.rows do
    largest = math.max(largest, math.abs(expected[i]))
    if math.abs(got[i] - expected[i]) > worst then worst, at = math.abs(got[i] - expected[i]), i end
  end
  assert(largest > 0, "no force")
  assert(worst < tolerance * largest, ("off by %.1e of the force at t = %g: %g, not %g"):format(worst / largest,
    (at - 1) * record.dt, got[at], expected[at]))
end

-- Two tones and a slow part: inner loops, and a mean that moves.
local wander = motion({ { 0.03, 9 }, { 0.017, 23 } }, 0.01)
local two_tones = motion { { 0.03, 9 }, { 0.017, 23 } }

--- k (y - ys) with |.| <= limit: one step of return mapping.
local function slip(k, limit)
  local z, last = 0, 0
  return function(y, bound)
    z = clip(z + k * (y - last), -(bound or limit), bound or limit)
    last = y
    return z
  end
end

spec.case("elastic_slip: return mapping, and the loop's area 4 Fs (A - Fs/k)", function()
  local rule = slip(300, 3)
  compare(effects.elastic_slip { k = 300, Fs = 3 }, wander, 2, function(y) return rule(y) end, 2e-5)
  local A, Fs, k = 0.05, 3, 300
  local record = record_of(A*lunid.sin(2*pi*t), 2, 1e-3)
  local f, v, area = force_of(effects.elastic_slip { k = k, Fs = Fs }, record), record:column "v", 0
  for i = 1001, 2000 do area = area + (f[i]*v[i] + f[i + 1]*v[i + 1])/2 * record.dt end
  spec.near(area, 4*Fs*(A - Fs/k), 1e-5)
end)

spec.case("backlash_play: carried along by its edges", function()
  local z = 0
  compare(effects.backlash_play { k = 300, g = 0.012 }, wander, 2, function(y)
    z = clip(z, y - 0.012, y + 0.012)
    return 300 * (y - z)
  end, 2e-5)
end)

spec.case("friction_lift_off: the limit follows the motion, down to nothing", function()
  local f = slip(300)
  compare(effects.friction_lift_off { k = 300, fN = 1.5, kf = 70 }, wander, 2,
    function(y) return f(y, math.max(1.5 + 70*y, 0)) end, 5e-4, 200)
end)

spec.case("smith_shaft and rate_power_law: the rate part opposes the motion always", function()
  local f = slip(300, 3)
  compare(effects.smith_shaft { Ru = 3, q = 0.01, J = 0.8 }, wander, 2, function(y, v)
    local Rs = f(y)
    return Rs + 0.8*math.abs(Rs)*v
  end, 1e-4)
  local g = slip(300, 3)
  compare(effects.rate_power_law { Ru = 3, q = 0.01, J = 0.8, n = 0.3 }, wander, 2, function(y, v)
    local Rs = g(y)
    return Rs + 0.8*math.abs(Rs)*math.abs(v)^0.3*(v > 0 and 1 or -1)
  end, 1e-3)
end)

spec.case("smith_toe: Smith's incremental rule, with a gap that opens", function()
  local ys, Ru, q, J = 0, 4, 0.01, 0.5
  local opened, yielded = 0, 0
  compare(effects.smith_toe { Ru = Ru, q = q, J = J }, wander, 2, function(y, v)
    ys = math.max(ys, y - q)
    local R = clip(Ru/q * (y - ys), 0, Ru)
    if R == 0 then opened = opened + 1 elseif R == Ru then yielded = yielded + 1 end
    return R > 0 and math.max(R + J*R*v, 0) or 0
  end, 1e-4)
  assert(opened > 100 and yielded > 100, "the gap never opens, or the soil never yields")
end)

spec.case("shaft_softening: the limit falls with the slipped path", function()
  local Ru, Rr, q, sr = 4, 1, 0.008, 0.2
  local z, path, last = 0, 0, 0
  compare(effects.shaft_softening { Ru = Ru, Rr = Rr, q = q, sr = sr }, wander, 2, function(y)
    local trial = z + (y - last)/q
    z, last = clip(trial, -1, 1), y
    path = path + math.abs(trial - z)*q
    return (Rr + (Ru - Rr)*math.exp(-path/sr))*z
  end, 1e-4)
end)

spec.case("degrading_resistance: the limit falls with the work done in slip", function()
  for _, rinf in ipairs { 0.3, 0, 1 } do
    local Ru, q, Nc = 4, 0.008, 0.6
    local z, N, last = 0, 0, 0
    compare(effects.degrading_resistance { Ru = Ru, q = q, rinf = rinf, Nc = Nc }, wander, 2, function(y)
      local trial = z + (y - last)/q
      z, last = clip(trial, -1, 1), y
      local R = Ru*(rinf + (1 - rinf)*math.exp(-N/Nc))
      N = N + R*math.abs(trial - z)*q
      return R*z
    end, 5e-4)
  end
end)

spec.case("degrading_resistance, variant 2: the limit alone falls, under a stiffness that stays", function()
  for _, rinf in ipairs { 0.3, 0, 1 } do
    local Ru, q, Nc = 4, 0.008, 0.6
    local f, N = slip(Ru/q), 0
    local before, last = 0, 0
    compare(effects.degrading_resistance { variant = 2, Ru = Ru, q = q, rinf = rinf, Nc = Nc }, wander, 2, function(y)
      local trial = before + Ru/q*(y - last)
      before, last = f(y, Ru*(rinf + (1 - rinf)*math.exp(-N/Nc))), y
      N = N + math.abs(before)*math.abs(trial - before)*q/Ru
      return before
    end, 1e-3)
  end
end)

spec.case("setup_recovery, depth_resistance, vibro_liquefaction: limits that change beside the slip", function()
  local f = slip(300)
  local R = 1
  compare(effects.setup_recovery { k = 300, R0 = 4, Ri = 1, tau = 0.7 }, wander, 2, function(y, _, _, h)
    R = R + h*(4 - R)/0.7
    return f(y, R)
  end, 1e-3)
  local g, slow = slip(300), 0
  compare(effects.depth_resistance { k = 300, Ru0 = 1, b = 60, tau = 0.3 }, wander, 2, function(y, _, _, h)
    slow = slow + h*(y - slow)/0.3
    return g(y, math.max(1 + 60*slow, 0))
  end, 1e-3)
  local e, square = slip(300), 0
  compare(effects.vibro_liquefaction { k = 300, Rs = 4, Rl = 1, tau = 0.3 }, wander, 2, function(y, _, a, h)
    square = square + h*(a^2 - square)/0.3
    return e(y, 1 + 3*math.exp(-math.sqrt(2*square)/9.80665))
  end, 2e-3)
  -- in a steady harmonic motion the amplitude is that of the acceleration
  local A, w = 0.02, 40
  local force = force_of(effects.vibro_liquefaction { k = 3000, Rs = 4, Rl = 1, tau = 2 },
    record_of(A*lunid.sin(w*t), 12, 0.002))
  spec.near(force:max(), 4, 0.05)  -- before it has shaken
  local late = 0
  for i = 5001, 6001 do late = math.max(late, force[i]) end
  spec.near(late, 1 + 3*math.exp(-A*w^2/9.80665), 5e-3)
end)

spec.case("soil_plug: moves along, or is torn loose", function()
  local mp, k, Fs, u, z = 0.4, 400, 2, 0, 0
  compare(effects.soil_plug { mp = mp, k = k, Fs = Fs }, wander, 1.5, function(_, v, _, h)
    z = clip(z + h*k*(v - u), -Fs, Fs)
    u = u + h*z/mp
    return z
  end, 2e-3, 200)
end)

-- ---- Masing ----

--- The extended rules of Masing: branches over a stack of reversals, closed where they meet what they left.
local function masing(backbone)
  local stack, last, direction = {}, 0, 0  -- of { y, f } where the motion turned
  local function value(at)
    local top = stack[#stack]
    if not top then return backbone(at) end
    return top.f + 2*backbone((at - top.y)/2)
  end
  return function(at)
    local turn = at > last and 1 or at < last and -1 or direction
    if direction ~= 0 and turn ~= direction then stack[#stack + 1] = { y = last, f = value(last) } end
    direction, last = turn, at
    while #stack > 0 do  -- an inner loop closes at the reversal before the last; the first branch at its mirror image
      local outer = stack[#stack - 1]
      local limit = outer and outer.y or -stack[1].y
      if #stack == 1 and math.abs(at) < math.abs(limit) or #stack > 1 and (at - limit)*direction < 0 then break end
      stack[#stack] = nil
      stack[#stack] = nil
    end
    return value(at)
  end
end

spec.case("masing_soil: a stack of reversals on its backbone, which is the hyperbola within 0.62 %", function()
  local k, yr, share, reach = 300, 0.015, {}, {}
  for i = 0, 20 do share[i] = i < 20 and math.cos(i*pi/40)^2 or 0 end
  for i = 1, 20 do reach[i] = yr*(2/(share[i - 1] + share[i]) - 1) end
  local function polygon(x)
    local sum = 0
    for i = 1, 20 do sum = sum + k*(share[i - 1]^2 - share[i]^2)*clip(x, -reach[i], reach[i]) end
    return sum
  end
  for i = 1, 400 do
    local x = 1e-3*yr*1.03^i
    local ratio = polygon(x)/(k*x/(1 + x/yr))
    assert(ratio > 1 - 1e-12 and ratio < 1.0062, ratio)
  end
  compare(effects.masing_soil { k = k, yr = yr }, two_tones, 3, masing(polygon), 2e-4)
  compare(effects.iwan { k = k, Fs = k*yr, n = 1 }, two_tones, 3, masing(polygon), 2e-4)
end)

spec.case("iwan: its backbone at several shapes, and the loop's area by Masing's 8 U - 4 A f(A)", function()
  for _, row in ipairs { { 0.7, 0.0144 }, { 1, 0.0062 }, { 2, 0.0031 }, { 8, 0.0009 } } do
    local n, error = table.unpack(row)
    local k, Fs = 300, 4
    local function backbone(x) return k*x/(1 + (k*x/Fs)^n)^(1/n) end
    local record = record_of(0.1*t, 1, 1e-3)  -- far beyond Fs/k = 13 mm
    local force, at = force_of(effects.iwan { k = k, Fs = Fs, n = n }, record), record:column "y"
    for i = 2, 1001 do
      local ratio = force[i] / backbone(at[i])
      assert(ratio > 1 - 1e-6 and ratio < 1 + error, ("n = %g, y = %g: %g of the backbone"):format(n, at[i], ratio))
    end
  end
  local A, k, yr = 0.05, 300, 0.015
  local record = record_of(A*lunid.sin(2*pi*t), 2, 1e-3)
  local f, v, area = force_of(effects.masing_soil { k = k, yr = yr }, record), record:column "v", 0
  for i = 1001, 2000 do area = area + (f[i]*v[i] + f[i + 1]*v[i + 1])/2 * record.dt end
  local U, end_force = k*yr*(A - yr*math.log(1 + A/yr)), k*A/(1 + A/yr)
  spec.near(area / (8*U - 4*A*end_force), 1, 0.01)
end)

-- ---- viscoelastic ----

--- Storage and loss of an element under A sin(w t), from whole periods at the end.
local function moduli(element, w, settle)
  local periods, points, A = settle + 1, 400, 0.02
  local record = record_of(A*lunid.sin(w*t), 2*pi/w*periods, 2*pi/w/points)
  local force, storage, loss = force_of(element, record), 0, 0
  for i = 1, points do
    local x = force[settle*points + i]
    storage = storage + 2/points * x * math.sin(2*pi*(i - 1)/points)
    loss = loss + 2/points * x * math.cos(2*pi*(i - 1)/points)
  end
  return storage / A, loss / A
end

spec.case("maxwell_relaxation: storage and loss moduli", function()
  local k, tau = 200, 0.05
  for _, w in ipairs { 3, 20, 130 } do
    local storage, loss = moduli(effects.maxwell_relaxation { k = k, tau = tau }, w, 12)
    local x = w*tau
    spec.near(storage, k*x^2/(1 + x^2), 1e-4*k)
    spec.near(loss, k*x/(1 + x^2), 1e-4*k)
  end
end)

--- Real and imaginary part of the entry's own transfer function: spring, relaxations and damper, read off its equations.
local function transfer(p, w, omega)
  local entry, real, imaginary = effects.fractional_damping, 0, 0
  local at = { fractional_damping_c = 1, fractional_damping_p = p, fractional_damping_w = w, y = 0, v = 0 }
  for _, state in ipairs(entry.states) do at[state.name] = 0 end
  local function weight_of(name)
    at[name] = 1
    local weight = entry.variants[1]:at(at)
    at[name] = 0
    return weight
  end
  for _, state in ipairs(entry.states) do
    local weight = weight_of(state.name)
    at[state.name] = 1
    local rate = -state.rate:at(at)
    at[state.name] = 0
    real = real + weight*omega^2/(rate^2 + omega^2)  -- i omega/(rate + i omega)
    imaginary = imaginary + weight*omega*rate/(rate^2 + omega^2)
  end
  return real + weight_of "y", imaginary + omega*weight_of "v"
end

spec.case("fractional_damping: c (i omega)^p over its band, at any p", function()
  local w = 40
  for _, p in ipairs { 0.01, 0.05, 0.2, 0.5, 0.8, 0.95, 0.99 } do
    for _, band in ipairs { { 3, 3e-4 }, { 10, 0.006 } } do
      for i = 0, 60 do
        local omega = w * band[1]^(i/30 - 1)
        local real, imaginary = transfer(p, w, omega)
        local dr = real - omega^p*math.cos(p*pi/2)
        local di = imaginary - omega^p*math.sin(p*pi/2)
        local error = math.sqrt(dr^2 + di^2) / omega^p
        assert(error < band[2], ("p = %g at %g w: %.2g"):format(p, omega/w, error))
      end
    end
  end
  local storage, loss = moduli(effects.fractional_damping { c = 40, p = 0.5, w = 20 }, 20, 60)  -- and in a simulation
  spec.near(storage, 40*math.sqrt(20)*math.cos(pi/4), 1e-3*40*math.sqrt(20))
  spec.near(loss, 40*math.sqrt(20)*math.sin(pi/4), 1e-3*40*math.sqrt(20))
end)

-- ---- Bouc-Wen and its kin ----

spec.case("bouc_wen at n = 1: exponentials on loading and unloading", function()
  local k, zy, rho, A = 200, 0.01, 0.8, 0.03
  local record = record_of(A*(1 - lunid.cos(2*pi*t))/2, 1, 1e-3)
  local force, at = force_of(effects.bouc_wen { k = k, zy = zy, rho = rho, n = 1 }, record), record:column "y"
  local top = zy*(1 - math.exp(-A/zy))
  local s = (2*rho - 1)/zy  -- unloading while z > 0: dz/dy = 1 + s z
  for i = 1, 501, 10 do spec.near(force[i], k*zy*(1 - math.exp(-at[i]/zy)), 1e-5) end
  for i = 501, 1001, 10 do
    local z = ((1 + s*top)*math.exp(s*(at[i] - A)) - 1)/s
    if z > 0 then spec.near(force[i], k*z, 1e-5) end
  end
end)

spec.case("bouc_wen that stiffens as it is loaded, n = 1: exponentials", function()
  local k, zy, rho, A = 200, 0.02, 0.8, 0.03
  local record = record_of(A*(1 - lunid.cos(2*pi*t))/2, 1, 1e-3)
  local force = force_of(effects.bouc_wen { k = k, zy = zy, rho = rho, n = 1, variant = 2 }, record)
  local at, top, s = record:column "y", zy*(math.exp(A/zy) - 1), (2*rho + 1)/zy
  for i = 1, 501, 10 do spec.near(force[i], k*zy*(math.exp(at[i]/zy) - 1), 1e-5) end
  for i = 501, 1001, 10 do
    local z = ((1 + s*top)*math.exp(s*(at[i] - A)) - 1)/s
    if z > 0 then spec.near(force[i], k*z, 1e-5) end
  end
end)

spec.case("lugre_friction: sliding evenly it is g(v), and stiff at first", function()
  local s0, s1, Fc, Fs, vs = 4000, 5, 1.5, 2.2, 0.1
  for _, speed in ipairs { 0.02, 0.1, 0.5 } do
    local record = record_of(speed*t, 2, 1e-3)
    local force = force_of(effects.lugre_friction { s0 = s0, s1 = s1, Fc = Fc, Fs = Fs, vs = vs }, record)
    spec.near(force[2001], Fc + (Fs - Fc)*math.exp(-(speed/vs)^2), 1e-6)
    spec.near(force[1], s1*speed, 1e-9)  -- z = 0, dz/dt = v
  end
end)

spec.case("pinching_degrading_hysteresis: Baber and Noori's equations by the classical Runge-Kutta method", function()
  local k, zy, rho, n, dnu, deta, zs, q, p, psi, dpsi, lambda = 300, 0.012, 0.7, 1.2, 0.02, 0.03, 0.8, 0.15, 0.4, 0.2,
    0.01, 0.4
  -- in the variables of the papers: beta, gamma, A = 1, energy over the stiffness (Foliente 1995, equations 7 to 16)
  local beta, gamma = rho/zy^n, (1 - rho)/zy^n
  local function sgn(x) return x > 0 and 1 or x < 0 and -1 or 0 end
  local function rates(z, energy, v)
    local e = energy/zy^2
    local nu, eta = 1 + dnu*e, 1 + deta*e
    local zeta1 = zs*(1 - math.exp(-p*e))
    local zeta2 = (psi + dpsi*e)*(lambda + zeta1)
    local zu = (1/(nu*(beta + gamma)))^(1/n)
    local h = 1 - zeta1*math.exp(-((z*sgn(v) - q*zu)/zy)^2/zeta2^2)
    local dz = h*(v - nu*(beta*math.abs(v)*math.abs(z)^(n - 1)*z + gamma*v*math.abs(z)^n))/eta
    return dz, z*v
  end
  local z, energy, now = 0, 0, 0
  local function speed(at) return 0.03*9*math.cos(9*at) + 0.017*23*math.cos(23*at) end
  compare(effects.pinching_degrading_hysteresis { k = k, zy = zy, rho = rho, n = n, dnu = dnu, deta = deta, zs = zs, q = q,
    p = p, psi = psi, dpsi = dpsi, lambda = lambda }, two_tones, 4, function(_, _, _, h)
    local v0, v1, v2 = speed(now), speed(now + h/2), speed(now + h)
    local a1, b1 = rates(z, energy, v0)
    local a2, b2 = rates(z + h/2*a1, energy + h/2*b1, v1)
    local a3, b3 = rates(z + h/2*a2, energy + h/2*b2, v1)
    local a4, b4 = rates(z + h*a3, energy + h*b3, v2)
    z, energy, now = z + h/6*(a1 + 2*a2 + 2*a3 + a4), energy + h/6*(b1 + 2*b2 + 2*b3 + b4), now + h
    return k*z
  end, 1e-4, 25)
  assert(energy/zy^2 > 20, "it has hardly worn")
end)

spec.clean()
spec.finish()
