return function(effect)
  return effect {
    name = "clipping",
    family = "sensor",
    measures = { { y = "min(max(y, -level), level)" }, { y = "min(y, level)" }, { y = "max(y, -level)" } },
    any_motion = true,
    formula = { "y measured = min(max(y, -level), level)", "y measured = min(y, level)", "y measured = max(y, -level)" },
    parameters = { { "level", min = 0, unit = "m" } },
    guess = function(scale, variant)
      local peak = variant == 2 and scale.y_max or variant == 3 and -scale.y_min or math.max(scale.y_max, -scale.y_min)
      peak = math.max(peak, 1e-3 * scale.y_std)
      return { { level = peak }, { level = 0.9 * peak } }
    end,
    range = function(scale)
      local peak = math.max(scale.y_max, -scale.y_min)
      return { level = { 1e-4 * peak, 1.2 * peak } }
    end,
    passive = true,
    signature = "flat tops: y stays at its extreme while the motion goes on; odd harmonics, even ones where one side clips",
    sentence = "the displacement channel saturates: the motion went further than it shows",
    confusers = { "one_sided_stop", "clearance", "cubic_stiffness" },
    source = "McConnell and Varoto 2008, Vibration Testing, chapter 5 (overload and clipping)",
  }
end
