-- `lunid check STUDY.lua`: reads a study without running it. Finds what Lua itself would let pass or find late.
local catalogue = require "lunid.catalogue"
local core = require "lunid.core"
local element = require "lunid.element"
local records = require "lunid.records"
local schema = require "lunid.schema"
local strict = require "lunid.strict"

local check = {}

local keywords = {}
for word in ([[and break do else elseif end false for function goto if in local nil not or repeat return then true
               until while]]):gmatch "%S+" do
  keywords[word] = true
end

--- Tokens { kind = "name" | "word" | "string" | "number" | "symbol", text, line }.
local function tokens_of(text)
  local tokens, at, line = {}, 1, 1
  local function add(kind, piece)
    if kind then tokens[#tokens + 1] = { kind = kind, text = piece, line = line } end
    line = line + select(2, piece:gsub("\n", ""))
    at = at + #piece
  end
  while at <= #text do
    local long = text:match("^%-%-%[(=*)%[", at)
    local bracket = text:match("^%[(=*)%[", at)
    local quote = text:match("^[\"']", at)
    if long or bracket then
      local stop = select(2, text:find("]" .. (long or bracket) .. "]", at, true)) or #text
      add(bracket and "string", text:sub(at, stop))
    elseif text:match("^%-%-", at) then add(nil, text:match("^[^\n]*", at))
    elseif text:match("^%s", at) then add(nil, text:match("^%s+", at))
    elseif quote then
      local stop = at + 1
      while stop <= #text and text:sub(stop, stop) ~= quote do
        stop = stop + (text:sub(stop, stop) == "\\" and 2 or 1)
      end
      add("string", text:sub(at, stop))
    elseif text:match("^[%a_]", at) then
      local name = text:match("^[%w_]+", at)
      add(keywords[name] and "word" or "name", name)
    elseif text:match("^%.?%d", at) then add("number", text:match("^0[xX][%x%.]+", at) or text:match("^[%d%.]+[eE][%+%-]?%d+", at) or text:match("^[%d%.]+", at))
    else add("symbol", text:match("^[=~<>]=", at) or text:match("^%.%.%.?", at) or text:match("^::", at) or text:sub(at, at)) end
  end
  return tokens
end

--- Names that the study declares anywhere: locals, arguments, loop variables, functions. Scopes are not told apart:
--- a name that is declared too late passes here and is found when the study runs.
local function declared_names(tokens)
  local declared = {}
  local i = 1
  while i <= #tokens do
    local token = tokens[i]
    if token.text == "local" and tokens[i + 1] and tokens[i + 1].text == "function" then
      if tokens[i + 2] then declared[tokens[i + 2].text] = true end
      i = i + 1  -- its arguments are those of any function
    elseif token.text == "local" or token.text == "for" then
      i = i + 1
      while tokens[i] and (tokens[i].kind == "name" or tokens[i].text == ",") do
        if tokens[i].kind == "name" then declared[tokens[i].text] = true end
        i = i + 1
        if tokens[i] and tokens[i].text == "<" then i = i + 3 end
      end
    elseif token.text == "function" then
      i = i + 1
      while tokens[i] and tokens[i].text ~= "(" do i = i + 1 end
      while tokens[i] and tokens[i].text ~= ")" do
        if tokens[i].kind == "name" then declared[tokens[i].text] = true end
        i = i + 1
      end
    else
      i = i + 1
    end
  end
  return declared
end

local openers = { ["{"] = "}", ["("] = ")", ["["] = "]" }

--- Calls `visit(token, i, inside)` with the innermost open bracket (its token, or nil) of each token.
local function walk(tokens, visit)
  local open = {}
  for i, token in ipairs(tokens) do
    visit(token, i, open[#open])
    if token.kind == "symbol" and openers[token.text] then
      open[#open + 1] = { text = token.text, at = i }
    elseif token.text == "function" and token.kind == "word" then
      open[#open + 1] = { text = "function", at = i }
    elseif token.kind == "word" and (token.text == "do" or token.text == "then" or token.text == "repeat") then
      if token.text ~= "then" or not (open[#open] and open[#open].text == "if") then
        open[#open + 1] = { text = token.text == "then" and "if" or token.text, at = i }
      end
    elseif token.kind == "word" and (token.text == "end" or token.text == "until") then
      open[#open] = nil
    elseif token.kind == "word" and token.text == "elseif" or token.text == "else" then
      if open[#open] and open[#open].text == "if" and token.text == "elseif" then open[#open] = nil end
    elseif token.kind == "symbol" and (token.text == "}" or token.text == ")" or token.text == "]") then
      open[#open] = nil
    end
  end
end

local function is_field(tokens, i, inside)
  local before, after = tokens[i - 1], tokens[i + 1]
  if before and (before.text == "." or before.text == ":" or before.text == "::" or before.text == "goto") then return true end
  if before and before.text == "<" and after and after.text == ">" then return true end  -- local name <const>
  return inside and inside.text == "{" and after and after.text == "=" and before
    and (before.text == "{" or before.text == "," or before.text == ";")
end

--- Names bound to expressions: locals made from lunid's signals and parameters.
local function expressions_in(text)
  local found = {}
  for names, values in text:gmatch "local%s+([%w_,%s]-)%s*=%s*([^\n]*)" do
    if values:match "lunid%.parameter" or values:match "lunid%.displacement" or values:match "lunid%.velocity"
      or values:match "lunid%.acceleration" or values:match "lunid%.time" or values:match "lunid%.state" then
      for name in names:gmatch "[%a_][%w_]*" do found[name] = true end
    end
  end
  return found
end

local function contains(list, word)
  for _, each in ipairs(list) do
    if each == word then return true end
  end
  return false
end

--- The constructor whose braces open at `inside`: tokens lunid . name { (also lunid . figure . lines {, and
--- lunid . read ( "run.csv" , {).
local function constructor_at(tokens, inside)
  if not inside or inside.text ~= "{" then return nil end
  local at = inside.at - 1
  if tokens[at] and tokens[at].text == "," and tokens[at - 1].kind == "string" and tokens[at - 2].text == "(" then
    at = at - 2
  end
  if tokens[at] and tokens[at].text == "(" then at = at - 1 end
  local parts = {}
  while tokens[at] and tokens[at].kind == "name" do
    table.insert(parts, 1, tokens[at].text)
    if not (tokens[at - 1] and tokens[at - 1].text == ".") then break end
    at = at - 2
  end
  if parts[1] ~= "lunid" or #parts < 2 then return nil end
  if #parts == 3 and parts[2] == "effects" and contains(catalogue.names, parts[3]) then
    return element.definition(catalogue.entry(parts[3]))
  end
  return schema.definitions[table.concat(parts, ".", 2)]
end

local signs_of_literals = { ["{"] = 1, ["}"] = -1, [","] = 0, [";"] = 0, ["="] = 0, ["-"] = 0 }

--- The value that is written from token `i` on, where it is nothing but strings, numbers, true, false and tables of them.
local function literal_at(tokens, i)
  local words, depth = {}, 0
  while tokens[i] do
    local token, text = tokens[i], tokens[i].text
    if depth == 0 and (text == "," or text == ";" or text == "}") then break end
    local is_key = token.kind == "name" and depth > 0 and tokens[i + 1] and tokens[i + 1].text == "="
    local step = token.kind == "symbol" and signs_of_literals[text]
    if not (step or is_key or token.kind == "string" or token.kind == "number" or text == "true" or text == "false") then
      return nil
    end
    depth, words[#words + 1], i = depth + (step or 0), text, i + 1
  end
  local chunk = load("return " .. table.concat(words, " "), "", "t", {})
  return chunk and chunk()
end

--- What the call would say of a value that is written for a field, or nil.
local function problem_of_value(definition, name, value)
  local good, message = pcall(function()
    schema.check_value(definition, name, value)
    if name == "catalogue" or name == "without" then catalogue.check_names(definition.name .. ": " .. name, value) end
  end)
  return not good and tostring(message):gsub("^%S+:%d+: ", "") or nil
end

local files_of = { read = true, stream = true, table = true, load = true }

--- The file that tokens lunid . read "run.csv" at `i` = read name, or nil.
local function file_at(tokens, i)
  if not files_of[tokens[i].text] then return nil end
  local at = tokens[i + 1] and tokens[i + 1].text == "(" and i + 2 or i + 1
  local token = tokens[at]
  local ends = token and tokens[at + 1] and tokens[at + 1].text
  if not token or token.kind ~= "string" or ends == ".." or ends == "." then return nil end
  return load("return " .. token.text, "", "t", {})()
end

--- All that is wrong or doubtful: list of { line, text, fatal }. A study may write what it reads itself.
function check.findings(text)
  local lunid = require "lunid"
  local tokens, found = tokens_of(text), {}
  local declared, expressions = declared_names(tokens), expressions_in(text)
  local environment = strict.environment ""
  local writes = text:find(":save", 1, true) or text:find("%f[%w]io%.") or text:find("%f[%w]os%.")
  local function add(line, words, fatal) found[#found + 1] = { line = line, text = words, fatal = fatal } end
  walk(tokens, function(token, i, inside)
    local before, after = tokens[i - 1], tokens[i + 1]
    if token.kind == "name" and not is_field(tokens, i, inside) then
      if not declared[token.text] and rawget(environment, token.text) == nil then
        add(token.line, strict.words_of_undeclared(token.text, {}), true)
      end
    elseif token.kind == "name" and before and before.text == "." and tokens[i - 2].text == "lunid" then
      local good, message = pcall(function() return lunid[token.text] end)
      if not good then add(token.line, tostring(message):gsub("^%S+:%d+: ", ""), true) end
      local file = file_at(tokens, i)
      if file and not core.kind_of(records.find(file)) then
        add(token.line, ("no such file: '%s'"):format(file), not writes)
      end
    elseif token.kind == "name" and before and before.text == "." and tokens[i - 2].text == "effects"
      and tokens[i - 4] and tokens[i - 4].text == "lunid" then
      local good, message = pcall(function() return lunid.effects[token.text] end)
      if not good then add(token.line, tostring(message):gsub("^%S+:%d+: ", ""), true) end
    elseif token.kind == "name" then
      local definition = constructor_at(tokens, inside)
      if definition and after and after.text == "=" and definition.style ~= "arguments" then
        local problem = schema.problem_of_name(definition, token.text)
        if problem then
          problem = definition.name .. ": " .. problem
        else
          local value = literal_at(tokens, i + 2)
          problem = value and problem_of_value(definition, token.text, value)
        end
        if problem then add(token.line, problem, true) end
      end
    elseif token.kind == "symbol" and (token.text == "==" or token.text == "~=") then
      local name = before and expressions[before.text] and before.text or after and expressions[after.text] and after.text
      if name then
        add(token.line, ("'%s' with the expression '%s' compares identity at once and gives true or false; "
          .. "for a condition use lunid.greater, lunid.less and lunid.where"):format(token.text, name), false)
      end
    end
  end)
  return found
end

local of_records = { csv = true, txt = true, dat = true, tsv = true, mat = true, h5 = true, hdf5 = true }

--- Raises where there is no such file, or it is a record.
function check.expect_study(path)
  local kind = core.kind_of(path)
  if not kind then core.raise(("no such study: '%s'"):format(path), "usage") end
  if kind == "directory" then core.raise(("'%s' is a directory; expected a study, such as study.lua"):format(path), "usage") end
  if of_records[(path:match "%.(%w+)$" or ""):lower()] then
    core.raise(("'%s' is a record, not a study: type `lunid discover %s --mass M --restoring \"k*y + c*v\"`, or write a "
      .. "study, such as study.lua, that has lunid.read \"%s\""):format(path, path, path), "usage")
  end
end

--- Prints the findings with file and line; exit code 1 when one of them would stop the study.
function check.study(path)
  check.expect_study(path)
  strict.load_file(path)
  records.folder = core.parent_of(path)
  local fatal = 0
  for _, finding in ipairs(check.findings(core.read_text(path))) do
    print(("%s:%d: %s%s"):format(path, finding.line, finding.fatal and "" or "warning: ", finding.text))
    fatal = fatal + (finding.fatal and 1 or 0)
  end
  if fatal == 0 then print(path .. ": nothing that would stop it") end
  return fatal > 0 and 1 or 0
end

return check
