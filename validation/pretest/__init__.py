"""`massline pretest`: before a test, what it would tell, where pick-ups belong, and what to mind (paper, section 2.2)."""
