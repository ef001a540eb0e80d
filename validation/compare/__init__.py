"""`massline compare`: where a model fails, in sigmas, in per cent and in words."""
