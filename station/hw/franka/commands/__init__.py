"""From the handles of FrankaHW to the commands of the arm."""
