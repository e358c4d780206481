-- Where a run's files go: gathered beside the out directory, renamed into it when the run is done.
local core = require "lunid.core"

local output = {}
local current  -- { out = what the user asked for, partial = where files are gathered }

--- Raises where a run cannot write to `out`: a file, or a directory that holds other things than an earlier run.
function output.expect_free(out)
  local kind = core.kind_of(out)
  if kind == "file" then core.raise(("--out: '%s' is a file, not a directory"):format(out), "usage") end
  if kind == "directory" and not core.is_empty_directory(out) and not core.kind_of(out .. "/run.json") then
    core.raise(("--out: the directory '%s' holds other things than an earlier run (it has no run.json); "
      .. "choose another or empty it"):format(out), "usage")
  end
end

--- Begins a run that writes to `out`. Of the ranks that run one study together (mpirun) the first one writes; the files of
--- the others are thrown away.
function output.begin(out, rank)
  output.expect_free(out)
  local partial = ("%s.partial-%d"):format((out:gsub("/+$", "")), core.process_id())
  if rank > 0 then partial = ("%s-%d"):format(partial, rank) end
  local good, message = pcall(core.make_directories, partial)
  if not good then  -- what the user asked for, not the name that it has meanwhile
    core.raise(("--out: cannot make the directory '%s': %s"):format(out, message:match "([^:]*)$":gsub("^ ", "")), "usage")
  end
  current = { out = (out:gsub("/+$", "")), partial = partial, silent = rank > 0, folder = "" }
end

--- Does `work` with its files in a folder below the out directory: true, or false and its error.
function output.within(folder, work)
  local before = current.folder
  current.folder = before .. folder .. "/"
  local good, message = pcall(work)
  current.folder = before
  return good, message
end

local function is_relative(path) return path:sub(1, 1) ~= "/" end

--- The path to write to for a path that a study names; relative ones lie below the out directory.
function output.place(path)
  if not current or not is_relative(path) then return path end
  for part in path:gmatch "[^/]+" do
    if part == ".." then core.raise(("save: '%s' leaves the out directory; give an absolute path"):format(path), "study") end
  end
  local full = current.partial .. "/" .. current.folder .. path
  core.make_directories(core.parent_of(full))
  return full
end

--- Makes a folder to write to, wherever it is.
function output.make_folder(path) core.make_directories(output.place(path)) end

--- The path as the user will find it.
function output.shown(path)
  if not current or not is_relative(path) then return path end
  return current.out .. "/" .. current.folder .. path
end

--- Whether the run has written that file, by either of its names, but it is not there before the run ends; what an
--- earlier run has left there is none of it.
function output.is_gathered(path)
  if not current then return false end
  local out, inside = current.out .. "/", nil
  if path:sub(1, #out) == out then
    inside = path:sub(#out + 1)
  elseif is_relative(path) and not core.kind_of(path) then
    inside = current.folder .. path
  end
  return inside ~= nil and core.kind_of(current.partial .. "/" .. inside) == "file"
end

function output.write(path, text)
  core.write_text(output.place(path), text)
  return output.shown(path)
end

function output.write_json(path, value) return output.write(path, core.json_text(value)) end

--- A path beside the out directory, or nil where there is none.
function output.beside(name) return current and current.out .. "." .. name end

--- Does this run own an out directory? (Not in the REPL.)
function output.active() return current ~= nil end

local function earlier_files(out)
  if not core.kind_of(out .. "/run.json") then return {} end
  local good, run = pcall(function() return core.parse_json(core.read_text(out .. "/run.json")) end)
  return good and type(run) == "table" and run.files or {}
end

--- Renames the gathered files into the out directory, run.json last, and removes what only the earlier run had.
function output.commit(run)
  if current.silent then
    core.remove_all(current.partial)
    current = nil
    return {}
  end
  local files = core.list_files(current.partial)
  local kept = { ["run.json"] = true }
  for _, file in ipairs(files) do kept[file] = true end
  run.files = files
  output.write_json("run.json", run)
  local stale = earlier_files(current.out)
  for _, file in ipairs(files) do
    core.make_directories(core.parent_of(current.out .. "/" .. file))
    core.rename(current.partial .. "/" .. file, current.out .. "/" .. file)
  end
  core.make_directories(current.out)
  core.rename(current.partial .. "/run.json", current.out .. "/run.json")
  for _, file in ipairs(stale) do
    local path = current.out .. "/" .. file
    if not kept[file] and is_relative(file) and not file:find("..", 1, true) and core.kind_of(path) == "file" then
      core.remove_all(path)
    end
  end
  core.remove_all(current.partial)
  current = nil
  return files
end

--- "report.html, figures (4 files)", each after `prefix`: folders as one.
local function listed(files, prefix)
  local names, counts = {}, {}
  for _, file in ipairs(files) do
    local top = file:match "^[^/]+"
    if not counts[top] then names[#names + 1] = top end
    counts[top] = (counts[top] or 0) + (file == top and 0 or 1)
  end
  for i, name in ipairs(names) do
    local count = counts[name]
    names[i] = prefix .. name .. (count > 0 and (" (%d file%s)"):format(count, count > 1 and "s" or "") or "")
  end
  return table.concat(names, ", ")
end

--- "out/report.html, out/figures (4 files)": what a run wrote.
function output.summary(out, files) return listed(files, out .. "/") end

--- Where the files of a run that failed are kept; those of an earlier one there are replaced, other things are not.
local function failed_folder(run)
  local folder = run.out .. ".failed"
  local kind = core.kind_of(folder)
  if kind == "directory" and core.kind_of(folder .. "/error.txt") then core.remove_all(folder) end
  return core.kind_of(folder) and run.partial or folder
end

--- Ends a run that failed, or was interrupted, with `message`. Whole files that it made are kept beside the out directory;
--- says what was kept.
function output.abandon(message, interrupted)
  local run = current
  current = nil
  local files = not run.silent and core.list_files(run.partial) or {}
  local earlier = core.kind_of(run.out) and ("; '%s' is as it was"):format(run.out) or ""
  if #files == 0 then
    core.remove_all(run.partial)
    return "nothing was written" .. earlier
  end
  local kept = run.partial
  if not interrupted then
    local good = pcall(function()
      core.write_text(run.partial .. "/error.txt", message .. "\n")
      kept = failed_folder(run)
      if kept ~= run.partial then core.rename(run.partial, kept) end
    end)
    if not good then kept = run.partial end
  end
  return ("finished files are kept in '%s': %s%s"):format(kept, listed(files, ""), earlier)
end

return output
