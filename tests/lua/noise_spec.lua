-- What sensors do to a record: sizes within statistical bounds, the same bits for the same seed, and messages.
local lunid = require "lunid"
local spec = require "spec"

local noise = lunid.noise
local y, v = lunid.displacement, lunid.velocity

local clean = lunid.simulate {
  model = lunid.model { mass = 1, restoring = 400*y + 2*v },
  excitation = lunid.excitation.harmonic { amplitude = 30, frequency = 2, dt = 0.002, duration = 40 },
}:record()
local rows = clean.rows  -- 20001

--- noisy - clean of a channel, as a list.
local function error_of(noisy, channel)
  local a, b, difference = noisy:column(channel), clean:column(channel), {}
  for i = 1, rows do difference[i] = a[i] - b[i] end
  return difference
end

local function std(list)
  local mean, square = 0, 0
  for _, value in ipairs(list) do mean = mean + value / #list end
  for _, value in ipairs(list) do square = square + (value - mean) ^ 2 / #list end
  return math.sqrt(square)
end

local function same(a, b, channel)
  local x, z = a:column(channel), b:column(channel)
  for i = 1, #x do
    if x[i] ~= z[i] then return false end
  end
  return true
end

spec.case("a number is Gaussian noise over the channel's standard deviation", function()
  local noisy = clean:with_noise { y = 0.05, v = 0.02, seed = 3 }
  local sy, sv = clean:column("y"):std(), clean:column("v"):std()
  local bound = 4 / math.sqrt(2 * rows)  -- four standard deviations of a standard deviation
  spec.near(std(error_of(noisy, "y")) / sy, 0.05, 0.05 * bound)
  spec.near(std(error_of(noisy, "v")) / sv, 0.02, 0.02 * bound)
  assert(same(noisy, clean, "F") and same(noisy, clean, "a"))
  spec.near(noisy.channels.y.noise, 0.05 * sy, 0.003 * sy)  -- what is estimated from the spectrum
end)

spec.case("the same seed gives the same bits, another seed other ones", function()
  local one = clean:with_noise { y = 0.05, v = 0.05, seed = 3 }
  assert(same(one, clean:with_noise { y = 0.05, v = 0.05, seed = 3 }, "y"))
  assert(same(one, clean:with_noise { y = 0.05, seed = 3 }, "y"), "noise on v changes that on y")
  assert(not same(one, clean:with_noise { y = 0.05, v = 0.05, seed = 4 }, "y"))
  local y_error, v_error, product = error_of(one, "y"), error_of(one, "v"), 0
  for i = 1, rows do product = product + y_error[i] * v_error[i] / rows end
  spec.near(product / std(y_error) / std(v_error), 0, 4 / math.sqrt(rows))  -- channels are independent
end)

spec.case("without a seed it is that of the run", function()
  local study = [[
local lunid = require "lunid"
local record = lunid.excitation.step { height = 1, dt = 0.1, duration = 1 }
print(("%a"):format(record:with_noise { F = lunid.noise.gaussian { std = 1 }, seed = SEED }:column "F"[3]))
]]
  spec.write("default.lua", (study:gsub("SEED", "nil")))
  spec.write("two.lua", (study:gsub("SEED", "2")))
  local first = spec.lunid "run default.lua --out seeds"
  spec.equal(spec.lunid "run default.lua --out seeds --seed 1", first)
  local second = spec.lunid "run default.lua --out seeds --seed 2 --threads 2"
  assert(second ~= first)
  spec.equal(spec.lunid "run two.lua --out seeds", second)
end)

spec.case("a list is applied in its order", function()
  local record = clean:with_noise { y = { noise.gaussian { std = 1 }, noise.clipped { level = 0.5 } }, seed = 1 }
  spec.equal(record:column("y"):max(), 0.5)
  local other = clean:with_noise { y = { noise.clipped { level = 0.5 }, noise.gaussian { std = 1 } }, seed = 1 }
  assert(other:column("y"):max() > 2)
end)

spec.case("each kind does what it says", function()
  local function y_with(fault) return clean:with_noise { y = fault, seed = 9 } end
  local sy = clean:column("y"):std()
  local uniform = error_of(y_with(noise.uniform { half_width = 0.01 }), "y")
  spec.near(std(uniform), 0.01 / math.sqrt(3), 1e-4)
  local pink = error_of(y_with(noise.coloured { exponent = 1, relative = 0.1 }), "y")
  spec.near(std(pink), 0.1 * sy, 1e-9)
  local function neighbour(x)  -- correlation of neighbours: 0 for white noise
    local sum, square = 0, 0
    for i = 1, #x - 1 do sum, square = sum + x[i] * x[i + 1], square + x[i] ^ 2 end
    return sum / square
  end
  assert(neighbour(pink) > 0.5)
  spec.near(neighbour(error_of(y_with(noise.coloured { ar = { 0.9 }, std = 0.01 }), "y")), 0.9, 0.02)
  spec.near(neighbour(uniform), 0, 4 / math.sqrt(rows))
  local gain = error_of(y_with(noise.multiplicative { std = 0.1 }), "y")
  spec.near(std(gain), 0.1 * clean:column("y"):rms(), 0.01 * sy)
  local counts = y_with(noise.poisson { count = 1e-4 }):column "y"
  for i = 1, rows, 97 do spec.near(counts[i] / 1e-4, math.floor(counts[i] / 1e-4 + 0.5), 1e-6) end
  local stepped = y_with(noise.quantised { bits = 8 }):column "y"
  local step = 2 * math.max(clean:column("y"):max(), -clean:column("y"):min()) / 255
  for i = 1, rows, 97 do assert(math.abs(stepped[i] - clean:column "y"[i]) <= 0.501 * step) end
end)

spec.case("what was lost or hit is counted in the warnings", function()
  local record = clean:with_noise {
    y = { noise.dropped { fraction = 0.02 }, noise.outliers { fraction = 0.001, relative = 8 } },
    v = { noise.clipped { relative = 0.5 }, noise.dropped { fraction = 0.02, fill = "linear" } },
    seed = 5,
  }
  spec.equal(#record.warnings, 4)
  local lost = tonumber(record.warnings[3]:match "^channel 'y': (%d+) of 20001 rows were lost; each repeats the one before it$")
  spec.near(lost, 400, 4 * math.sqrt(400))
  for _, warning in ipairs(record.warnings) do assert(warning:match "^channel '[yv]': %d+ of 20001 rows ", warning) end
end)

spec.case("rows that are no numbers are refused by a reader, with their line", function()
  local record = clean:window(0, 1):with_noise { y = noise.dropped { fraction = 0.05, fill = "gap" }, seed = 5 }
  local values, first = record:column("y"):list(), nil
  for i = #values, 1, -1 do
    if values[i] ~= values[i] then first = i end
  end
  spec.contains(record.warnings[1], "were lost; they are not numbers")
  local path = spec.folder .. "/gaps.csv"
  record:save(path)
  local good, message = pcall(lunid.read, path)
  assert(not good)
  spec.contains(message, ("gaps.csv:%d: column 'y [m]': expected a number, got 'nan'"):format(first + 1))
end)

spec.case("noise on the force keeps its formula and adds to it", function()
  local push = lunid.excitation.harmonic { amplitude = 3, frequency = 5, dt = 0.01, duration = 1 }
  local noisy = push:with_noise { F = noise.uniform { half_width = 0.3 }, seed = 1 }
  spec.equal(noisy.channels.F.formula, push.channels.F.formula)
  local model = lunid.model { mass = 1, restoring = 400*y + 2*v }
  local a = lunid.simulate { model = model, excitation = push }:column "y"[101]
  local b = lunid.simulate { model = model, excitation = noisy }:column "y"[101]
  assert(a ~= b)
end)

local function refused(text, body) spec.equal(spec.message_of(body), text) end

spec.case("messages", function()
  refused("with_noise: the record has no channel 'yy', did you mean 'y'?", function() clean:with_noise { yy = 0.1 } end)
  refused("with_noise: the record has no channel 'torque' (it has F, y, v, a)",
    function() clean:with_noise { torque = 0.1 } end)
  refused("with_noise: y: expected >= 0, got -0.1", function() clean:with_noise { y = -0.1 } end)
  refused("with_noise: y: expected a number, a noise from lunid.noise or a list of them, got the string 'much'",
    function() clean:with_noise { y = "much" } end)
  refused("with_noise: seed: expected a whole number >= 0, got 1.5",
    function() clean:with_noise { y = 0.1, seed = 1.5 } end)
  refused("with_noise: expected a table { channel = noise, ... }, got 0.05", function() clean:with_noise(0.05) end)
  refused("noise.gaussian: give either std, in the channel's unit, or relative", function() noise.gaussian {} end)
  refused("noise.gaussian: std: expected > 0, got -1", function() noise.gaussian { std = -1 } end)
  refused("noise.gaussian: unknown field 'sigma' (fields: std, relative)", function() noise.gaussian { sigma = 1 } end)
  refused("noise.coloured: give either exponent, of the spectrum, or ar, of the rows",
    function() noise.coloured { std = 1 } end)
  refused("autoregressive_noise: the series grows by a factor of 1.2 per row; expected less than 1",
    function() clean:with_noise { y = noise.coloured { ar = { 1.2 }, std = 1 } } end)
  refused("noise.outliers: fraction: expected > 0 and <= 1, got 3",
    function() noise.outliers { fraction = 3, size = 1 } end)
  refused("noise.quantised: give either step, in the channel's unit, or bits", function() noise.quantised {} end)
  refused("noise.quantised: range goes with bits, not with step", function() noise.quantised { step = 1, range = 2 } end)
  refused("lunid.noise has no 'gausian', did you mean 'gaussian'?", function() return noise.gausian end)
end)

spec.clean()
spec.finish()
