% The oven of model.py in MATLAB's language, which GNU Octave runs as well; oven_matlab.py asks it.
% time s, power W and door 0 or 1 are columns; p is a struct of the nuisances, strengths and settings.
function temperature = oven(time, power, door, p)
  temperature = zeros(size(time));
  now = p.start;
  for k = 1:numel(time)
    temperature(k) = now + p.sensor_offset_offset;
    if k == numel(time)
      break
    end
    step = (time(k + 1) - time(k)) / 4;
    loss = p.loss + p.door_leak_loss * door(k);
    for substep = 1:4
      heat = power(k) - loss * (now - 20);
      heat = heat - 5.67e-8 * p.radiation_area * ((now + 273.15)^4 - 293.15^4);
      now = now + step * heat / p.capacity;
    end
  end
end
