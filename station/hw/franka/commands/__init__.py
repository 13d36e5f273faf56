"""Pass the commands of FrankaHW's handles on to the arm."""
