"""`massline identify` around the driver: what is asked, the known article, classical results as data, tables, JSON, pictures."""
