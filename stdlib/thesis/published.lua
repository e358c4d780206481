-- What the thesis prints, as data: nothing here was made by Lunid. Polynomials are lists of { power of y, power of v,
-- coefficient }, Chebyshev series lists of { variable, order, coefficient } of T(variable, order) at raw SI arguments.
local lunid = require "lunid"
local y, v = lunid.displacement, lunid.velocity

local published = {}

-- Section 2.3. RFS: in coordinates normalised to -1 ... 1, of opposite sign (24 terms).
published.case1 = {
  rx = { { 5, 0, -3.891e6 }, { 4, 1, -1.981e4 }, { 3, 2, -262.7 }, { 3, 0, 1.039e6 }, { 1, 2, 12.45 }, { 1, 0, 2.059e4 },
    { 0, 1, 9.123 } },
  pysindy = { { 4, 1, -2.409e4 }, { 3, 2, -260.4 }, { 3, 0, 8.949e5 }, { 2, 1, 448.8 }, { 1, 2, 15.13 }, { 1, 0, 2.0e4 },
    { 0, 1, 7.844 } },
  rfs = { { 4, 4, 88.0 }, { 4, 3, 11.99 }, { 4, 2, -48.06 }, { 4, 1, -1.426 }, { 4, 0, 382.9 }, { 3, 4, 85.17 }, { 3, 3, 4.28 },
    { 3, 2, -42.14 }, { 3, 1, -172.0 }, { 3, 0, -5578.0 }, { 2, 4, -135.4 }, { 2, 3, -35.17 }, { 2, 2, 111.8 }, { 2, 1, 114.1 },
    { 2, 0, -240.9 }, { 1, 4, -188.9 }, { 1, 3, -4.608 }, { 1, 2, 214.6 }, { 1, 1, 63.0 }, { 1, 0, -6107.0 }, { 0, 4, 147.9 },
    { 0, 3, -47.4 }, { 0, 2, -212.5 }, { 0, 1, -221.7 }, { 0, 0, 534.1 } },
  rfs_r2 = 0.85,  -- figure 2.14, of the training force
}

-- Section 2.4 and appendix M.
published.case2 = {
  rx = { { 5, 0, -6.635e6 }, { 3, 0, 6.346e5 }, { 1, 2, 32.01 }, { 1, 0, 7557 }, { 0, 1, 8.502 } },
  pysindy = { { 3, 0, 3.501e5 }, { 1, 2, 38.29 }, { 1, 0, 8019 }, { 0, 1, 4.86 } },
  rfs = { { 4, 4, 2.961 }, { 4, 3, 7.325 }, { 4, 2, -22.31 }, { 4, 1, -42.58 }, { 4, 0, 606.8 }, { 3, 4, -311.6 },
    { 3, 3, -10.97 }, { 3, 2, 454.4 }, { 3, 1, 58.46 }, { 3, 0, -739.4 }, { 2, 4, -50.79 }, { 2, 3, 1.12 }, { 2, 2, 73.68 },
    { 2, 1, 26.46 }, { 2, 0, -477.9 }, { 1, 4, 568.8 }, { 1, 3, 26.62 }, { 1, 2, -929.2 }, { 1, 1, -43.04 }, { 1, 0, -5088.0 },
    { 0, 4, 56.34 }, { 0, 3, -127.9 }, { 0, 2, -32.28 }, { 0, 1, -210.4 }, { 0, 0, -58.26 } },
  -- case 2.1: no damping term, raw arguments
  chebyshev = { { "y", 1, 2590 }, { "y", 2, 47.98 }, { "y", 3, -450.7 }, { "y", 5, 586.5 }, { "y", 7, -704.6 }, { "y", 9, 830.3 },
    { "y", 11, -931.5 }, { "y", 13, 882.1 }, { "y", 15, -444.0 }, { "y", 17, -490.7 }, { "y", 19, 1596 } },
}

-- Section 2.6: param0, the slope that the thesis found; the coefficient of its tanh came out negative.
published.case3 = { slope = 84.9 }

-- Table A.1, forces per unit of mass. The f1 of Tip Force 1 stood in a figure that is lost.
local shaft3 = { { "y", 1, 645.3 }, { "y", 2, 4.89e4 }, { "y", 3, 995.3 }, { "y", 4, 3.411e4 }, { "y", 5, 2927 },
  { "y", 6, 1.516e4 }, { "y", 7, 2326 }, { "y", 8, 2.994e4 }, { "y", 9, 5210 }, { "v", 1, 59.94 }, { "v", 2, 29.41 },
  { "v", 3, 184.5 }, { "v", 4, 16.53 }, { "v", 5, 95.46 }, { "v", 6, 9.004 }, { "v", 7, 35.37 }, { "v", 8, 1.733 }, { "v", 9, 6.807 } }
local combined = { { "y", 1, 682.4 }, { "y", 2, 5.792e4 }, { "y", 3, 1059 }, { "y", 4, 3.478e4 }, { "y", 5, 3247 },
  { "y", 6, 1.654e4 }, { "y", 7, 2499 }, { "y", 8, 3.971e4 }, { "y", 9, 5767 }, { "v", 1, 89.58 }, { "v", 2, 29.41 },
  { "v", 3, 185.0 }, { "v", 4, 37.34 }, { "v", 5, 95.46 }, { "v", 6, 13.98 }, { "v", 7, 35.5 }, { "v", 8, 3.001 }, { "v", 9, 7.152 } }
published.pile = {
  shaft1 = { polynomial = { { 2, 1, -1.92e4 }, { 2, 0, -5.163e6 }, { 1, 2, -2944 }, { 1, 1, 1.822e4 }, { 1, 0, 4.324e4 },
    { 0, 3, 50.68 }, { 0, 2, -79.02 }, { 0, 1, -204.1 } } },
  shaft2 = { polynomial = { { 2, 1, -3.08e7 }, { 2, 0, -5.174e6 }, { 1, 2, 1.277e5 }, { 1, 1, 1.879e4 }, { 1, 0, 4.323e4 },
    { 0, 3, -613.1 }, { 0, 2, -80.38 } } },
  tip1 = { polynomial = { { 3, 0, -1.657e4 }, { 2, 1, 1.474e5 }, { 1, 2, -3.417e4 }, { 1, 1, -3.427e4 }, { 1, 0, -1.763e6 },
    { 0, 3, 76.62 }, { 0, 1, 20.54 } }, f1 = { 3.544e6, -0.0056, 2 } },
  tip2 = { polynomial = { { 3, 0, -2.348e9 }, { 2, 1, -2.44e6 }, { 1, 0, 6.529e4 }, { 0, 3, -257.9 }, { 0, 1, -80.07 } } },
  shaft3 = { polynomial = { { 2, 1, 31.5 }, { 1, 3, 24.32 } }, chebyshev = shaft3 },
  combined = { polynomial = { { 2, 1, 39.48 }, { 1, 3, 3652 } }, chebyshev = combined },  -- printed as Tip Force 3, too
  rfs_tip = { { 2, 2, 2.523 }, { 2, 1, 3.967 }, { 2, 0, -27.83 }, { 1, 2, 3.342 }, { 1, 1, 5.638 }, { 1, 0, -18.48 },
    { 0, 2, 2.463 }, { 0, 1, -19.11 }, { 0, 0, -158.7 } },
}

--- A polynomial as an expression whose coefficients are parameters; scale: of the coefficients.
function published.polynomial(terms, scale)
  local sum = 0
  for _, term in ipairs(terms) do
    local feature = y^term[1] * v^term[2]
    local name = "p" .. term[1] .. term[2]
    sum = sum + lunid.parameter { name, term[3] * (scale or 1) } * feature
  end
  return sum
end

--- T(x, n), by its recurrence.
function published.T(x, n)
  local before, now = 1, x
  for _ = 2, n do before, now = now, 2*x*now - before end
  return n == 0 and 1 or now
end

--- A series of Chebyshev polynomials as an expression.
function published.chebyshev(terms, scale)
  local sum = 0
  for _, term in ipairs(terms) do
    sum = sum + lunid.parameter { ("T%s%d"):format(term[1], term[2]), term[3] * (scale or 1) }
      * published.T(term[1] == "y" and y or v, term[2])
  end
  return sum
end

--- A model of mass 1 kg with a published polynomial.
function published.model(terms) return lunid.model { mass = 1, restoring = published.polynomial(terms) } end

--- Coefficients of T_n over 1, x, x^2 ...
local function powers_of(n)
  local before, now = { 1 }, { 0, 1 }
  if n == 0 then return before end
  for _ = 2, n do
    local after = {}
    for i = 1, #now + 1 do after[i] = 2*(now[i - 1] or 0) - (before[i] or 0) end
    before, now = now, after
  end
  return now
end

--- The coefficient of y^i v^j in normalised coordinates, from those of T_k T_l.
local function normalised(chebyshev, i, j)
  local sum = 0
  for k = 1, #chebyshev do
    for l = 1, #chebyshev[k] do
      sum = sum + chebyshev[k][l] * (powers_of(k - 1)[i + 1] or 0) * (powers_of(l - 1)[j + 1] or 0)
    end
  end
  return sum
end

--- The published expression of a surface beside that of `surface`, in normalised coordinates. The thesis prints it with
--- the opposite sign.
function published.rfs_table(terms, surface)
  local rows = {}
  for i, term in ipairs(terms) do
    rows[i] = { ("y^%d v^%d"):format(term[1], term[2]), term[3], -term[3], normalised(surface.chebyshev, term[1], term[2]) }
  end
  return { head = { "term", "as printed", "sign turned", "Lunid" }, rows = rows,
    caption = "The surface as a polynomial of coordinates normalised to -1 ... 1; the ranges of the thesis' data are not known. "
      .. "(1.4) prints the factor as (1 + delta_i0)/pi; it is (2 - delta_i0)/pi, and the weight is that of the normalised coordinate" }
end

return published
