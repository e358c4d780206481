-- A file as a rig in trouble writes it: a logger that lost rows twice, a cell without a number, spikes of the displacement's
-- channel. What is refused is said with its line and with what to do; what can be mended is mended and noted.
-- "Nature" stands for the rig: it is used for nothing but the records.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local nature = lunid.model { mass = 2, restoring = 3e4*y + 25*v + 1.5e10*y^3 }
local function measure(seed)
  local shaker = lunid.excitation.multisine { from = 8, to = 45, rms = 14, dt = 1/600, duration = 5, seed = seed }
  local run = lunid.simulate { model = nature, excitation = shaker }:record():with_noise { y = 0.01, seed = seed }
  return run:column "F", run:column "y"
end

local path = os.tmpname()
local function write(cell)
  local F, w = measure(1)
  local file = assert(io.open(path, "w"))
  file:write "t [s],F [N],y [mm]\n"
  for i = 1, #F do
    local lost = i > 900 and i <= 902 or i > 1700 and i <= 1740
    local spike = (i == 501 or i == 2203) and 0.5 or 0  -- mm
    local shown = i == 1201 and cell or ("%.6f"):format(1e3*w[i] + spike)
    if not lost then file:write(("%.6f,%.5f,%s\n"):format((i - 1)/600, F[i], shown)) end
  end
  file:close()
end

--- What the reader says where it refuses the file.
local function refusal()
  local good, message = pcall(lunid.read, path)
  assert(not good)
  print((tostring(message):gsub(path:gsub("%p", "%%%0"), "rig.csv")))
  return tostring(message)
end

write "OVL"  -- the range was left: a cell that is no number, in line 1200 of the file
assert(refusal():find(":1200: column 'y [mm]': expected a number, got 'OVL'; mend it, or set resample = true", 1, true))
write(nil)   -- without it: now the time has gaps
assert(refusal():find(":902: gap: 2 rows are missing before t = 1.50333 s; gaps before lines 902, 1700", 1, true))

-- resample = true (--resample): rows with such a cell are taken for missing ones; short gaps are interpolated, at the long
-- one the record is cut into parts.
write "OVL"
local record = lunid.read(path, { resample = true })
os.remove(path)
for _, warning in ipairs(record.warnings) do print("warning: " .. warning) end
local pieces = record:pieces()
for i, piece in ipairs(pieces) do print(("part %d: %d rows from %.2f s on"):format(i, piece.rows, piece.start)) end
assert(#record.warnings == 2 and #pieces == 2)

-- The reader leaves single rows that no motion can have as they are; a discovery takes them out and notes it.
local k, c = lunid.parameter { "k", min = 0, unit = "N/m" }, lunid.parameter { "c", min = 0, unit = "N s/m" }
local F, w = measure(2)
local found = lunid.discover { model = lunid.model { mass = 2, restoring = k*y + c*v }, train = record,
  test = lunid.record { channels = { { "F", F }, { "y", w } }, dt = 1/600 }, catalogue = { "cubic_stiffness", "clearance" } }
print((tostring(found):gsub(path, "rig.csv")))
local noted = 0
for _, warning in ipairs(found.warnings) do noted = noted + (warning:find("off all neighbours", 1, true) and 1 or 0) end
assert(noted == 2)  -- one in each part
assert(found.verdict == "explained" and #found.effects == 1 and found.effects[1].name == "cubic_stiffness")
assert(math.abs(found.effects[1].parameters.k3.value/1.5e10 - 1) < 0.03)
